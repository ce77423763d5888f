// Ctrl-C, SIGTERM, a killed launcher, missed deadlines.
#include <csignal>
#include <ostream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Longer than any deadline, shorter than the silence after which peers give up.
constexpr Duration kFreeze = std::chrono::milliseconds{50};

void freeze(pid_t pid, Duration duration) {
    kill(pid, SIGSTOP);
    std::this_thread::sleep_for(duration);
    kill(pid, SIGCONT);
}

TEST(Signals, CtrlCKeepsWhatWasRecorded) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    EXPECT_NO_THROW(UdpChannel(network_at(run.base_port()).at(Port::kSessionOrders), {"127.0.0.1", 0}))
        << "without --monitor nobody listens for orders";
    run.launcher().signal(SIGINT);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("interrupted"));
    const TrialRow row = run.only_row();
    EXPECT_EQ(row.reason, EndReason::kInterrupted);
    const Trajectory trajectory = read_trajectory(run.trajectory_path(row.conditions));
    EXPECT_EQ(trajectory.reason, EndReason::kInterrupted);
    EXPECT_FALSE(trajectory.samples.empty());
    for (const char* program : kNodePrograms) EXPECT_FALSE(run.report(program).is_null()) << program;
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

// Some nodes have not yet asked the system for the signal that ends them with the launcher.
TEST(Signals, ALauncherThatIsKilledWhileItStartsItsNodesLeavesNoneBehind) {
    for (int i = 0; i < 3; ++i) {
        SessionFile session = SessionFile::endless();
        RealRun run(session);
        while (nodes_alive(run.base_port()).empty() && !run.launcher().poll()) std::this_thread::yield();
        run.launcher().signal(SIGKILL);
        EXPECT_EQ(run.end(), 128 + SIGKILL);
        EXPECT_TRUE(wait_until([&] { return nodes_alive(run.base_port()).empty(); }));
        for (const char* program : kNodePrograms) {
            for (const pid_t left : node_pids(run.base_port(), program)) kill(left, SIGKILL);
        }
    }
}

constexpr const char* kNoMissAllowed = "[runtime]\nallowed_miss_fraction = 0\n";

// Frozen while its loop turns, ended when it turns again: else there may be no deadline to miss.
bool misses_a_deadline(LoneNode& node) {
    HeardHeartbeats heartbeats(node, Role::kNetem);
    if (!heartbeats.wait_for_one_sent(SessionTime{})) return false;
    freeze(node.process().pid(), std::chrono::milliseconds{300});  // at least two heartbeats are due in it
    return heartbeats.wait_for_one_sent(wall_now());
}

TEST(StrictRealtime, AFrozenNodeEndsWith4AndWithoutTheFlagItIsOnlyCounted) {
    for (const bool strict : {true, false}) {
        LoneNode node("thimble-netem", kNoMissAllowed,
                      strict ? std::vector<std::string>{"--strict-rt"} : std::vector<std::string>{});
        ASSERT_TRUE(node.ready()) << node.words();
        ASSERT_TRUE(misses_a_deadline(node)) << node.words();
        EXPECT_EQ(node.terminate(), strict ? 4 : 0) << node.words();
        EXPECT_EQ(node.words().find("deadlines missed") != std::string::npos, strict) << node.words();
        EXPECT_GT(node.report().at("deadlines_missed"), 0);
    }
}

TEST(StrictRealtime, ARunCompletesAndEndsWith4) {
    SessionFile session = SessionFile::unhurried();
    session.more = kNoMissAllowed;
    RealRun run(session, {"--strict-rt"});
    const pid_t master = run.node("thimble-master");
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    freeze(master, kFreeze);
    expect_end(run, 4, EndReason::kCompleted, "deadlines missed");
    EXPECT_GT(run.report("thimble-master").at("samples_skipped"), 0);
}

// A node that dies or freezes in mid-trial: the others end the trial, what was recorded is kept, the culprit
// is named.
struct Victim {
    const char* program;
    Role role;
};

// The name that ctest shows. Without it ctest would show the bytes of a pointer, others in every run.
std::ostream& operator<<(std::ostream& out, const Victim& victim) { return out << victim.program; }

// Promised is about a second. A run that waited for the dead to acknowledge the end would outlast every test.
SessionFile patient_with_peers() {
    SessionFile session = SessionFile::endless();
    session.peer_wait_s = 10 * to_seconds(kPatience);
    return session;
}

void expect_lost(RealRun& run, const Victim& victim) {
    const std::string outcome = outcome_text(EndReason::kPeerLost, victim.role);
    EXPECT_EQ(outcome, std::string("peer_lost_") + to_string(victim.role));
    EXPECT_EQ(run.first_trial_end(), "# ended: " + outcome);
    EXPECT_EQ(run.end(), 3) << run.words();
    const TrialRow row = run.only_row();
    EXPECT_EQ(outcome_text(row.reason, row.lost_peer), outcome);
    EXPECT_FALSE(read_trajectory(run.trajectory_path(row.conditions)).samples.empty());
    EXPECT_TRUE(std::filesystem::exists(run.out() / "report.html"));
    EXPECT_THAT(nodes_alive(run.base_port()), testing::IsEmpty());
}

class KilledNode : public testing::TestWithParam<Victim> {};

TEST_P(KilledNode, EndsTheTrialWithItsNameOnRecord) {
    RealRun run(patient_with_peers());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    kill(run.node(GetParam().program), SIGKILL);
    EXPECT_THAT(run.first_trial_end(), testing::StartsWith("# ended: "));
    expect_lost(run, GetParam());
    EXPECT_THAT(run.words(), testing::HasSubstr(std::string(GetParam().program) + " ended with code 137"));
    for (const char* program : kNodePrograms) {
        EXPECT_EQ(run.report(program).is_null(), program == std::string(GetParam().program)) << program;
    }
}

// The other two: Play.AKilledWindow..., and OtherMachines.ANodeThatDies....
INSTANTIATE_TEST_SUITE_P(Each, KilledNode,
                         testing::Values(Victim{"thimble-netem", Role::kNetem},
                                         Victim{"thimble-cutaneous", Role::kCutaneous},
                                         Victim{"thimble-master", Role::kMaster}),
                         [](const auto& victim) { return std::string(to_string(victim.param.role)); });

// Without netem the others hear nothing of each other and all complain; the silent one is the culprit.
TEST(FrozenNode, IsFoundByItsSilence) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const pid_t netem = run.node("thimble-netem");
    kill(netem, SIGSTOP);
    EXPECT_EQ(run.first_trial_end(), "# ended: peer_lost_netem");
    kill(netem, SIGCONT);  // or the launcher waits for it in vain, some seconds long
    expect_lost(run, {"thimble-netem", Role::kNetem});
    EXPECT_THAT(run.words(), testing::HasSubstr("lost contact with netem"));
}

}  // namespace
}  // namespace thimble
