// A node's reaction to silent peers: no force, and the trial given up. The peers are the
// test.
#include "tests/loopback/lone_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/notify_socket.hpp"

namespace thimble {
namespace {

constexpr std::uint64_t kPeerInstance = 7;

ForceFeedback pushing(double force_N) {
    ForceFeedback feedback;
    feedback.force_total_N = feedback.force_fixture_N = -force_N;
    feedback.position_needle_m = 0.036;
    feedback.position_surface_m = 0.02;
    return feedback;
}

// slave_sim as its listeners know it, a sample per call.
class PlayedSlave {
  public:
    PlayedSlave(LoneNode& node, Port to) : flow_(Role::kSlaveSim, kPeerInstance, {node.peers().outlet(to)}) {}
    void push(SessionTime now) {
        ForceFeedback feedback = pushing(1.0);
        feedback.echo_time =
            now;  // as if the master's command had just come: an old answer presses no finger
        flow_.send(now, kPlayedTrial, feedback);
    }

  private:
    OutboundFlow flow_;
};

// Keeps the newest of what the node says.
template <class Body>
class Ear {
  public:
    Ear(LoneNode& node, Port at, Role node_role) : channel_(node.peers().inlet(at)), flow_(node_role) {}
    const Body& listen(SessionTime now) {
        flow_.drain<Body>(now, *channel_, true, kPlayedTrial, [this](const Header&, const Body& body) {
            newest = body;
            ++heard;
        });
        return newest;
    }
    Body newest;
    int heard = 0;

  private:
    Channel* channel_;
    InboundFlow flow_;
};

void expect_given_up(PlayedSession& session) {
    EXPECT_TRUE(session.play([](SessionTime) {}, [&] { return session.state() == NodeState::kFailed; }));
    EXPECT_EQ(session.reason(), EndReason::kPeerLost);
}

// A node says that it presses, while feedback comes, and that it gives no force once that stops.
template <class Body, class Force>
class ForceWhileFed {
  public:
    ForceWhileFed(LoneNode& node, Role role, Modality modality, Port feedback, Port said, Force force_N)
        : session(node, role, modality), ear(node, said, role), slave_(node, feedback), force_N_(force_N) {}

    bool presses(double least_N) {
        return session.play(
            [&](SessionTime now) {
                slave_.push(now);
                ear.listen(now);
            },
            [&] { return ear.heard > 0 && force_N_(ear.newest) >= least_N && force_N_(ear.newest) <= 1; });
    }
    bool releases() {
        return session.play([&](SessionTime now) { ear.listen(now); },
                            [&] { return force_N_(ear.newest) == 0; });
    }

    PlayedSession session;
    Ear<Body> ear;

  private:
    PlayedSlave slave_;
    Force force_N_;
};

TEST(LoneMaster, TakesTheForceOffTheHandleWhenFeedbackStops) {
    LoneNode node("thimble-master", "[master]\nstale_after_s = 0.02\n");
    ASSERT_TRUE(node.ready()) << node.words();
    const auto force_N = [](const NeedleCommand& said) { return said.force_hand_N; };
    ForceWhileFed<NeedleCommand, decltype(force_N)> test(node, Role::kMaster, Modality::kHF,
                                                         Port::kMasterForce, Port::kNetemNeedle, force_N);
    ASSERT_TRUE(test.presses(1));
    EXPECT_TRUE(test.releases());
    expect_given_up(test.session);
    EXPECT_EQ(node.terminate(), 0);
}

TEST(LoneSlave, HoldsTheNeedleWithoutForceWhenCommandsStop) {
    LoneNode node("thimble-slave-sim");
    ASSERT_TRUE(node.ready()) << node.words();
    PlayedSession session(node, Role::kSlaveSim, Modality::kHF);
    OutboundFlow master(Role::kMaster, kPeerInstance, {node.peers().outlet(Port::kSlaveNeedle)});
    Ear<ForceFeedback> force(node, Port::kNetemForceMaster, Role::kSlaveSim);
    NeedleCommand command;
    command.position_needle_m = command.position_needle_estimate_m = 0.036;  // 1 mm beyond the fixture
    ASSERT_TRUE(session.play(
        [&](SessionTime now) {
            master.send(now, kPlayedTrial, command);
            force.listen(now);
        },
        [&] { return force.newest.force_fixture_N < -2; }));
    EXPECT_FALSE(force.newest.needle_held);
    // More than once: a trial that is given up says it too, but only then and only once.
    int held = 0;
    EXPECT_TRUE(session.play(
        [&](SessionTime now) {
            const int before = force.heard;
            if (force.listen(now).needle_held) held += force.heard - before;
        },
        [&] { return held >= 3; }));
    EXPECT_EQ(force.newest.position_needle_m, command.position_needle_m);
    EXPECT_EQ(force.newest.force_total_N, 0);
    EXPECT_EQ(force.newest.force_fixture_N, 0);
    EXPECT_EQ(force.newest.force_tissue_N, 0);
    EXPECT_EQ(force.newest.contact_time_s, 0);
    expect_given_up(session);
    EXPECT_EQ(node.terminate(), 0);
}

TEST(LoneCutaneous, ReleasesTheFingerWhenFeedbackStops) {
    LoneNode node("thimble-cutaneous", "[cutaneous]\nstale_after_s = 0.02\n");
    ASSERT_TRUE(node.ready()) << node.words();
    const auto force_N = [](const Percept& felt) { return felt.force_N; };
    ForceWhileFed<Percept, decltype(force_N)> test(
        node, Role::kCutaneous, Modality::kCF, Port::kCutaneousForce, Port::kMasterPerceptCutaneous, force_N);
    ASSERT_TRUE(test.presses(1));
    EXPECT_EQ(test.ear.newest.finger, Finger::kIndex);
    EXPECT_TRUE(test.releases());
    EXPECT_EQ(node.terminate(), 0);
}

TEST(LoneVisual, DropsTheBarWhenFeedbackStops) {
    LoneNode node("thimble-visual", "[visual]\nstale_after_s = 0.02\npicture_delayed = true\n");
    ASSERT_TRUE(node.ready()) << node.words();
    const auto bar_N = [](const Percept& seen) { return seen.bar_N; };
    ForceWhileFed<Percept, decltype(bar_N)> test(node, Role::kVisual, Modality::kVF, Port::kVisualForce,
                                                 Port::kMasterPerceptVisual, bar_N);
    ASSERT_TRUE(test.presses(0.9));
    EXPECT_TRUE(test.releases());
    expect_given_up(test.session);
    EXPECT_EQ(node.terminate(), 0);
}

// A session that dies leaves no hand under force: each node notices on its own.
TEST(LoneNetem, GivesUpWithoutASession) {
    LoneNode node("thimble-netem");
    ASSERT_TRUE(node.ready()) << node.words();
    Channel* control = node.peers().between(Port::kSessionNetem, Port::kNetemControl);
    OutboundFlow orders(Role::kSession, kPeerInstance, {control});
    InboundFlow answers(Role::kNetem);
    const auto reaches = [&](NodeState state) {
        return wait_until([&] {
            while (const Message* message = answers.receive(SessionTime{}, *control)) {
                const auto* heartbeat = std::get_if<Heartbeat>(&message->body);
                if (heartbeat != nullptr && heartbeat->state == state) return true;
            }
            return false;
        });
    };
    ASSERT_TRUE(reaches(NodeState::kIdle));
    orders.send(SessionTime{}, kPlayedTrial, SessionControl{});  // start, then nothing more
    EXPECT_TRUE(reaches(NodeState::kRunning));
    EXPECT_TRUE(reaches(NodeState::kFailed));
    EXPECT_EQ(node.terminate(), 0);
}

// By commands of another terminal that hear nothing of each other, under a lab key.
TEST(LoneMaster, HoldsAStopUntilSomebodyWhoHasJustComeReleasesIt) {
    Folder folder;
    const std::filesystem::path key = folder / "lab.key";
    ASSERT_EQ(run_thimble({"keygen", key.string()}).code, 0);
    ASSERT_TRUE(std::filesystem::exists(key));  // or under_lab_key would make it
    const std::string config = under_lab_key(key);
    LoneNode node("thimble-master", config);
    ASSERT_TRUE(node.ready()) << node.words();
    const std::string port = std::to_string(node.at(Port{}).port);
    const std::vector<std::string> stop{
        "stop", folder.write("session.toml", config).string(), "--base-port", port, "--parallel-conditions",
        "1"};
    std::vector<std::string> why = stop, release = stop;
    why.insert(why.end(), {"--reason", "smoke\x1b[2J"});
    release.emplace_back("--release");
    EXPECT_EQ(run_thimble(why).code, 0);
    const Outcome released = run_thimble(release);
    EXPECT_EQ(released.code, 0) << released.words;
    EXPECT_THAT(released.words, testing::HasSubstr("released: smoke?[2J"));
    const Outcome again = run_thimble(release);
    EXPECT_EQ(again.code, 0) << again.words;
    EXPECT_THAT(again.words, testing::HasSubstr("nothing was stopped here"));
    EXPECT_EQ(node.terminate(), 0);
}

TEST(LoneNode, DoesNotTakeAnEmptyGrantKeyForNone) {
    setenv("THIMBLE_GRANT_KEY", "", 1);
    const Outcome refused = run_to_end(built_programs() / "thimble-master", {"--lock-step"});
    unsetenv("THIMBLE_GRANT_KEY");
    EXPECT_EQ(refused.code, 2) << refused.words;
    EXPECT_THAT(refused.words, testing::HasSubstr("THIMBLE_GRANT_KEY does not hold the key"));
}

TEST(LoneNode, RefusesAFolderForItsReportBeforeItListens) {
    const Folder folder;
    const Outcome refused =
        run_to_end(built_programs() / "thimble-master", {"--report", (folder / "").string()});
    EXPECT_EQ(refused.code, 2) << refused.words;
    EXPECT_THAT(refused.words, testing::HasSubstr("is a folder; name a file"));
}

// As systemd would hear it.
TEST(LoneNode, SaysToAServiceManagerWhenItListensThatItTurnsAndWhenItStops) {
    const Folder folder;
    for (const char* program : kNodePrograms) {
        const NotifySocket manager((folder / program).string());
        setenv("NOTIFY_SOCKET", (folder / program).c_str(), 1);
        setenv("WATCHDOG_USEC", "200000", 1);
        LoneNode node(program);
        unsetenv("NOTIFY_SOCKET");
        unsetenv("WATCHDOG_USEC");
        ASSERT_TRUE(node.ready()) << node.words();
        std::string heard;
        EXPECT_TRUE(wait_until([&] {
            heard += manager.heard();
            return heard.find("WATCHDOG=1\nWATCHDOG=1") != std::string::npos;
        })) << heard;
        EXPECT_EQ(node.terminate(), 0);
        heard += manager.heard();
        EXPECT_THAT(heard, testing::StartsWith("READY=1\n"));
        EXPECT_THAT(heard, testing::EndsWith("STOPPING=1\n"));
    }
}

}  // namespace
}  // namespace thimble
