// `thimble play` with the real programs: a scripted hand at the pointer, a scripted finger at the panel.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <sys/resource.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/records/metrics.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {
namespace {

using std::chrono::seconds;

// `thimble play` under test: the test plays the window (a scripted hand, in the visual node's name) and the panel
// (orders, in the experimenter's), and watches the Monitor as a panel does. thimble-visual runs with its recording display.
constexpr Duration kHandFrame = std::chrono::milliseconds{16};
constexpr double kHandSpeed_m_per_s = 0.02;

std::vector<std::string> play_arguments(const Folder& folder, const PortBlock& ports,
                                        const std::vector<std::string>& more) {
    const auto session = folder.write("session.toml",
                                      "[session]\nfixture_jitter_m = 0\n[fixture]\nposition_m = 0.035\n"
                                      "[trial]\ncontact_hold_s = 0.5\npeer_wait_s = 60\n" +
                                          std::string(kUnprotectedTable));
    return words_in(fmt::format("play {} --out {} --base-port {} --visual-command thimble-visual",
                                session.string(), (folder / "out").string(), ports.base()),
                    more);
}

class PlayedHand {
  public:
    // --out and ports are the helper's own. The fixture lies 35 mm deep, a contact of half a second beeps.
    explicit PlayedHand(const std::vector<std::string>& arguments)
        : sockets_(network_at(ports_.base())),
          hand_(Role::kVisual, 100, {sockets_.outlet(Port::kMasterHand)}),
          view_(ports_.base(), PlayedView::Ports::kExperimenter, kUnprotected),
          child_(built_programs() / "thimble", play_arguments(folder_, ports_, arguments),
                 folder_ / "words") {}

    // Moves the hand (60 inputs a second) and listens, until `done`; false if patience ended first, or the program did.
    bool play(const std::function<bool()>& done) {
        wait_until([&] {
            tick(wall_now());
            return done() || child_.poll();
        });
        return done();
    }
    bool play_for(Duration time) {
        const SessionTime end = wall_now() + time;
        return play([end] { return wall_now() >= end; });
    }

    // Where the hand goes, at 20 mm/s; none: no input at all.
    void go_to(double position_hand_m) { target_m_ = position_hand_m; }
    void leave() { present_ = false; }
    void order(OrderKind kind, double value = 0, Modality modality = Modality::kHF) {
        Order order;
        order.kind = kind;
        order.value = value;
        order.modality = modality;
        view_.order(wall_now(), order);
    }

    void network(const char* name) {
        Order order;
        order.kind = OrderKind::kNetwork;
        order.network = *NetworkName::of(name);
        view_.order(wall_now(), order);
    }

    const Monitor& monitor() const { return view_.monitor(); }
    std::uint32_t trial() const { return view_.trial(); }
    std::uint64_t monitors() const { return view_.heard(); }
    bool running() const { return view_.running(); }

    Child& launcher() { return child_; }
    int end() { return child_.wait(kPatience).value_or(-1); }
    int quit() {
        order(OrderKind::kQuit);
        return end();
    }
    std::uint16_t base_port() const { return ports_.base(); }
    std::filesystem::path out() const { return folder_ / "out"; }
    std::string words() const { return read_text(folder_ / "words"); }
    std::vector<TrialRow> rows() const { return read_trial_table(out() / "trials.csv"); }

  private:
    void tick(SessionTime now) {
        view_.listen(now);
        if (!present_ || now < next_) return;
        const double way_m = kHandSpeed_m_per_s * to_seconds(kHandFrame);
        wanted_m_ += std::clamp(target_m_ - wanted_m_, -way_m, way_m);
        if (running()) hand_.send(now, trial(), HandInput{wanted_m_, true});
        next_ = now + kHandFrame;
    }

    Folder folder_;
    PortBlock ports_;
    Sockets sockets_;
    OutboundFlow hand_;
    PlayedView view_;
    Child child_;
    bool present_ = true;
    double target_m_ = 0, wanted_m_ = 0;
    SessionTime next_{};
};

// 2 mm further than the fixture, at the hand: 1 N through the coupling.
constexpr double kPressed_m = 0.035 / 3 + 0.002;

void expect_nobody_left(const PlayedHand& hand) {
    EXPECT_TRUE(wait_until([&] { return nodes_alive(hand.base_port()).empty(); }));
}

// Advances, presses until the beep, withdraws; returns how the trial ended.
EndReason whole_trial(PlayedHand& hand) {
    EXPECT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.go_to(kPressed_m);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().beeped; })) << hand.words();
    hand.go_to(0);
    EXPECT_TRUE(hand.play([&] { return !hand.running(); })) << hand.words();
    return hand.monitor().reason;
}

TEST(WholeRunOfPlay, AHandThatFeelsTheFixtureEndsItsTrial) {
    PlayedHand hand({"--modality", "HF", "--delay-s", "0"});
    EXPECT_EQ(whole_trial(hand), EndReason::kCompleted);
    EXPECT_GT(hand.monitors(), 100U);
    EXPECT_GT(hand.monitor().accepted, 1000U);
    EXPECT_EQ(hand.quit(), 0) << hand.words();
    const auto rows = hand.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
    EXPECT_TRUE(rows[0].metrics.beeped);
    EXPECT_FALSE(rows[0].metrics.oscillates);
    const Trajectory trajectory = read_trajectory(hand.out() / "trajectories" / "trial01_HF_0ms.csv");
    EXPECT_EQ(trajectory.reason, EndReason::kCompleted);
    expect_nobody_left(hand);
}

TEST(WholeRunOfPlay, AtFiftyMillisecondsTheHandleOscillatesUntilItIsLetGo) {
    PlayedHand hand({"--modality", "HF", "--delay-s", "0.05"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.go_to(kPressed_m);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().energy_in_J < -0.1; }));  // more comes out than went in
    hand.leave();
    hand.play_for(seconds{2});
    const double rest_m = hand.monitor().position_needle_m;
    hand.play_for(seconds{1});
    EXPECT_TRUE(hand.running());  // the needle holds: no peer is lost
    EXPECT_FALSE(hand.monitor().needle_held);
    EXPECT_NEAR(hand.monitor().position_needle_m, rest_m, 1e-4);
    EXPECT_EQ(hand.quit(), 0) << hand.words();
    const auto rows = hand.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].reason, EndReason::kInterrupted);
    EXPECT_GE(rows[0].metrics.contacts_lost, 2U);
}

TEST(Play, LogsThatAnErrorNamesAreThereToBeRead) {
    const Folder folder;
    const PortBlock ports;
    const auto window = folder / "window";
    std::ofstream(window) << "#!/bin/sh\necho still looking for the screen\nexec sleep 60\n";
    std::filesystem::permissions(window, std::filesystem::perms::owner_all);
    const auto session = folder.write("session.toml", "[trial]\npeer_wait_s = 1.0\n");
    const Outcome play = run_thimble({"play", session.string(), "--visual-command", window.string(),
                                      "--base-port", std::to_string(ports.base())});
    EXPECT_EQ(play.code, 3) << play.words;
    const std::string before = "see the logs in ";
    const auto found = play.words.find(before);
    ASSERT_NE(found, std::string::npos) << play.words;
    const auto begin = found + before.size();
    const std::filesystem::path logs = play.words.substr(begin, play.words.find('\n', begin) - begin);
    bool quoted = false;
    std::error_code absent;
    for (const auto& file : std::filesystem::directory_iterator(logs, absent))
        quoted = quoted || read_text(file.path()) == "still looking for the screen\n";
    EXPECT_TRUE(quoted) << logs;
    std::filesystem::remove_all(logs.parent_path(), absent);
}

TEST(Play, APlayerAndAnExperimenterWatchTheSameTrialAndEitherChangesItsNetwork) {
    PlayedHand hand({"--modality", "VF", "--delay-s", "0"});
    PlayedView player(hand.base_port(), PlayedView::Ports::kPlayer, kUnprotected);
    const auto both_show = [&](const char* network) {
        return hand.play([&] {
            player.listen(wall_now());
            return hand.monitor().network.view() == network && player.monitor().network.view() == network;
        });
    };
    const auto ask = [&](const char* network) {
        Order order;
        order.kind = OrderKind::kNetwork;
        order.network = *NetworkName::of(network);
        return order;
    };
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    player.order(wall_now(), ask("nowhere"));
    player.order(wall_now(), ask("lte"));
    EXPECT_TRUE(both_show("lte")) << hand.words();
    EXPECT_EQ(hand.monitor().network_delay_s, 0.035);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().round_trip_s > 0.04; })) << hand.words();
    hand.network("geo");  // the experimenter's
    EXPECT_TRUE(both_show("geo")) << hand.words();
    EXPECT_TRUE(hand.play([&] { return hand.monitor().round_trip_s > 0.5; })) << hand.words();
    EXPECT_TRUE(hand.running());
    EXPECT_EQ(hand.trial(), 1U);
    EXPECT_EQ(hand.quit(), 0) << hand.words();
    const auto events = read_events(hand.out() / "trajectories" / "trial01_VF_0ms.events.csv");
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(events[0].profile, "lte");
    EXPECT_EQ(events[1].profile, "geo");
    EXPECT_EQ(events[1].needle.delay_s, 0.3);
}

TEST(Play, OrdersEndAndStartTrials) {
    PlayedHand hand({"--modality", "VF", "--delay-s", "0"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.order(OrderKind::kEndTrial);
    ASSERT_TRUE(hand.play([&] { return !hand.running(); }));
    EXPECT_EQ(hand.monitor().reason, EndReason::kInterrupted);
    hand.order(OrderKind::kDelay, 0.1);
    ASSERT_TRUE(hand.play([&] { return hand.monitor().network_delay_s == 0.1; }));
    hand.order(OrderKind::kStart, 0, Modality::kCF);
    hand.order(OrderKind::kStart, 0, Modality::kCF);  // as a panel repeats it
    ASSERT_TRUE(hand.play([&] { return hand.running(); }));
    EXPECT_EQ(hand.trial(), 2U);
    EXPECT_EQ(hand.monitor().modality, Modality::kCF);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().round_trip_s >= 0.1; }));
    hand.order(OrderKind::kStart, 0, Modality::kHF);  // ends the running one
    ASSERT_TRUE(hand.play([&] { return hand.running() && hand.trial() == 3; }));
    EXPECT_EQ(hand.quit(), 0) << hand.words();
    const auto rows = hand.rows();
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[1].conditions.delay_s, 0.1);
    EXPECT_EQ(rows[2].conditions.modality, Modality::kHF);
}

TEST(Play, AKilledWindowEndsTheSessionAndIsNamed) {
    PlayedHand hand({"--modality", "VF"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    const auto pids = node_pids(hand.base_port(), "thimble-visual");
    ASSERT_EQ(pids.size(), 1U);
    ::kill(pids.front(), SIGKILL);
    EXPECT_EQ(hand.end(), 3);
    EXPECT_NE(hand.words().find("thimble-visual ended with code 137"), std::string::npos) << hand.words();
    const auto rows = hand.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].lost_peer, Role::kVisual);
    expect_nobody_left(hand);
}

TEST(Play, AFullDiskEndsTheSessionAndIsNamed) {
    PlayedHand hand({"--modality", "VF"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    rlimit room{};  // of one file of the launcher
    ASSERT_EQ(prlimit(hand.launcher().pid(), RLIMIT_FSIZE, nullptr, &room), 0);
    room.rlim_cur = 8192;
    ASSERT_EQ(prlimit(hand.launcher().pid(), RLIMIT_FSIZE, &room, nullptr), 0);
    EXPECT_EQ(hand.end(), 1) << hand.words();
    EXPECT_NE(hand.words().find("check the disk's free space"), std::string::npos) << hand.words();
    ASSERT_EQ(hand.rows().size(), 1U);
    EXPECT_EQ(hand.rows()[0].lost_peer, Role::kSession);
    expect_nobody_left(hand);
}

TEST(Play, AClosedWindowIsAGoodEnd) {
    PlayedHand hand({"--modality", "VF"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    const auto pids = node_pids(hand.base_port(), "thimble-visual");
    ASSERT_EQ(pids.size(), 1U);
    ::kill(pids.front(), SIGTERM);  // it ends with 0, as when the user closes it
    EXPECT_EQ(hand.end(), 0) << hand.words();
    ASSERT_EQ(hand.rows().size(), 1U);
    EXPECT_EQ(hand.rows()[0].reason, EndReason::kInterrupted);
    expect_nobody_left(hand);
}

TEST(Play, CtrlCAndSecondsAreGoodEnds) {
    PlayedHand interrupted({"--modality", "VF"});
    ASSERT_TRUE(interrupted.play([&] { return interrupted.running(); })) << interrupted.words();
    interrupted.launcher().signal(SIGINT);
    EXPECT_EQ(interrupted.end(), 0) << interrupted.words();
    expect_nobody_left(interrupted);
    PlayedHand timed({"--modality", "VF", "--seconds", "1"});
    EXPECT_EQ(timed.end(), 0) << timed.words();
    expect_nobody_left(timed);
}

TEST(Play, SaysWhatIsWrongAtTheStart) {
    const Folder folder;
    const PortBlock ports;
    const auto expect_refused = [&](int code, const std::string& words, const std::string& window,
                                    const std::vector<std::string>& more) {
        const Outcome outcome = run_thimble(
            words_in(fmt::format("play --base-port {} --visual-command {}", ports.base(), window), more));
        EXPECT_EQ(outcome.code, code) << outcome.words;
        EXPECT_NE(outcome.words.find(words), std::string::npos) << outcome.words;
    };
    expect_refused(1, "no_such_program", folder / "no_such_program", {});
    const std::string out = folder.write("trials.csv", "something\n").parent_path();
    expect_refused(2, "trials.csv", "thimble-visual", {"--out", out});
    folder.write("dataset_description.json", R"({"SubjectKind": "human"})");
    expect_refused(2, "a dataset of human", "thimble-visual", {"--out", out});

    const NetworkSettings network = network_at(ports.base());
    const UdpChannel taken(network.at(Port::kSessionOrders), {"127.0.0.1", 0});
    expect_refused(3, std::to_string(network.at(Port::kSessionOrders).port), "thimble-visual", {});
    EXPECT_TRUE(nodes_alive(ports.base()).empty());
}

// `thimble play --replay`: what was played is shown again, by the real programs.
TEST(PlayReplay, ShowsWhatWasPlayed) {
    PlayedHand hand({"--modality", "CF", "--delay-s", "0"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.go_to(0.02);
    ASSERT_TRUE(hand.play([&] { return hand.monitor().time_s > 1.6; })) << hand.words();
    ASSERT_EQ(hand.quit(), 0) << hand.words();

    const Folder folder;
    const PortBlock ports;
    Child replay(built_programs() / "thimble",
                 {"play", "--replay", hand.out().string(), "--speed", "0.5", "--visual-command",
                  "thimble-visual", "--base-port", std::to_string(ports.base())},
                 folder / "words");
    PlayedView view(ports.base());
    const auto watch = [&](const std::function<bool()>& done) {
        return wait_until([&] {
                   view.listen(wall_now());
                   return done() || replay.poll();
               }) &&
               !replay.poll();
    };
    const auto say = [&](OrderKind kind, double value = 0) {
        Order order;
        order.kind = kind;
        order.value = value;
        view.order(wall_now(), order);
    };
    ASSERT_TRUE(watch([&] { return view.running() && view.monitor().time_s > 0.2; }))
        << read_text(folder / "words");
    EXPECT_EQ(view.monitor().modality, Modality::kCF);
    EXPECT_EQ(view.monitor().position_fixture_m, 0.035);
    say(OrderKind::kPause);
    ASSERT_TRUE(watch([&] { return view.monitor().paused; }));
    say(OrderKind::kSeek, 1.5);
    ASSERT_TRUE(watch([&] { return view.monitor().time_s == 1.5; }));
    EXPECT_GT(view.monitor().position_needle_m, 0.01);
    EXPECT_EQ(nodes_alive(ports.base()), std::vector<std::string>{"thimble-visual"});
    say(OrderKind::kQuit);
    EXPECT_EQ(replay.wait(kPatience).value_or(-1), 0) << read_text(folder / "words");
    EXPECT_TRUE(nodes_alive(ports.base()).empty());
}

TEST(PlayReplay, SaysWhichTrialThereIsNot) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome =
        run_thimble({"play", "--replay", (folder / "nothing").string(), "--visual-command", "thimble-visual",
                     "--base-port", std::to_string(ports.base())});
    EXPECT_EQ(outcome.code, 5);
    EXPECT_NE(outcome.words.find("trials.csv"), std::string::npos) << outcome.words;
    EXPECT_EQ(run_thimble({"play", "--trial", "2"}).code, 2);
    EXPECT_EQ(run_thimble({"play", "--replay", "nothing", "--out", (folder / "out").string()}).code, 2);
    for (const char* unused :
         {"--modality HF", "--delay-s 0", "--frames f --speed 2", "--video v --seconds 1"})
        EXPECT_EQ(run_thimble(words_in(std::string("play --replay nothing ") + unused)).code, 2) << unused;
    const auto session = folder.write("slow.toml", "[session]\ndelays_s = [1.3]\n");
    for (const std::vector<std::string>& shown :
         {std::vector<std::string>{"--visual-command", "thimble-visual", "--base-port",
                                   std::to_string(ports.base())},
          {"--frames", (folder / "frames").string()}})
        EXPECT_EQ(run_thimble(words_in("play " + session.string() + " --replay nothing", shown)).code, 5)
            << "a replay needs no delay that can be played";
}

TEST(PlayInABrowser, TakesNoOtherOption) {
    const Outcome outcome = run_thimble({"play", "--browser", "--modality", "HF"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.words.find("leave --modality out"), std::string::npos) << outcome.words;
}

}  // namespace
}  // namespace thimble
