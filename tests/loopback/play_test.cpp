// `thimble play` with the real programs: a scripted hand at the pointer, a scripted finger at the panel.
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "session/records/trajectory_file.hpp"
#include "tests/loopback/played_hand.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

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

TEST(WholeRunOfPlay, TheBarStaysCalmWithFiftyMilliseconds) {
    PlayedHand hand({"--modality", "VF", "--delay-s", "0.05"});
    EXPECT_EQ(whole_trial(hand), EndReason::kCompleted);
    EXPECT_EQ(hand.quit(), 0) << hand.words();
    const auto rows = hand.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_FALSE(rows[0].metrics.oscillates);
    EXPECT_EQ(rows[0].metrics.contacts_lost, 0U);
    EXPECT_GE(rows[0].round_trip_s, 0.05);
}

TEST(WholeRunOfPlay, AtFiftyMillisecondsTheHandleOscillatesUntilItIsLetGo) {
    PlayedHand hand({"--modality", "HF", "--delay-s", "0.05"}, "[slave_sim]\n");
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.go_to(kPressed_m);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().energy_in_J < -0.1; }));  // more comes out than went in
    EXPECT_LT(hand.monitor().energy_in_J, -0.1);
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

TEST(Play, TheDelayMovesInMidTrial) {
    PlayedHand hand({"--modality", "VF", "--delay-s", "0"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.play_for(milliseconds{300});
    hand.order(OrderKind::kDelay, 0.5);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().round_trip_s >= 0.5; })) << hand.words();
    EXPECT_EQ(hand.monitor().network_delay_s, 0.5);
    hand.order(OrderKind::kDelay, 0);
    EXPECT_TRUE(hand.play([&] { return hand.monitor().round_trip_s < 0.3; })) << hand.words();
    EXPECT_TRUE(hand.running());
    EXPECT_EQ(hand.trial(), 1U);  // the same trial all the time
    EXPECT_EQ(hand.quit(), 0) << hand.words();
    const auto changes = read_events(hand.out() / "trajectories" / "trial01_VF_0ms.events.csv");
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes[0].delay_s, 0.5);
    EXPECT_EQ(changes[1].delay_s, 0);
    EXPECT_GT(changes[1].time_s, changes[0].time_s);
}

TEST(Play, APlayerAndAnExperimenterWatchTheSameTrialAndEitherChangesItsNetwork) {
    PlayedHand hand({"--modality", "VF", "--delay-s", "0"});
    PlayedView player(hand.base_port(), PlayedView::Ports::kPlayer);
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
    const std::string base = std::to_string(ports.base());
    const auto program = built_programs() / "thimble";
    Outcome outcome = run_to_end(
        program, {"play", "--base-port", base, "--visual-command", (folder / "no_such_program").string()});
    EXPECT_NE(outcome.code, 0);
    EXPECT_NE(outcome.words.find("no_such_program"), std::string::npos) << outcome.words;

    std::ofstream(folder / "trials.csv") << "something\n";
    outcome = run_to_end(program, {"play", "--base-port", base, "--visual-command", "thimble-visual",
                                   "--record", folder.write("x", "").parent_path().string()});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.words.find("trials.csv"), std::string::npos) << outcome.words;

    const NetworkSettings network = network_at(ports.base());
    const UdpChannel taken(network.at(Port::kSessionOrders), {"127.0.0.1", 0});
    outcome = run_to_end(program, {"play", "--base-port", base, "--visual-command", "thimble-visual"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_NE(outcome.words.find(std::to_string(network.at(Port::kSessionOrders).port)), std::string::npos)
        << outcome.words;
    EXPECT_TRUE(nodes_alive(ports.base()).empty());
}

}  // namespace
}  // namespace thimble
