// Ctrl-C, SIGTERM, a killed launcher, missed deadlines.
#include <csignal>
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
    run.launcher().signal(SIGINT);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("interrupted"));
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.front().reason, EndReason::kInterrupted);
    const Trajectory trajectory = read_trajectory(run.trajectory_path(rows.front().conditions));
    EXPECT_EQ(trajectory.reason, EndReason::kInterrupted);
    EXPECT_FALSE(trajectory.samples.empty());
    for (const char* program : kNodePrograms) EXPECT_FALSE(run.report(program).is_null()) << program;
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

TEST(Signals, AKilledLauncherTakesItsNodesAlong) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    EXPECT_EQ(nodes_alive(run.base_port()).size(), kNodePrograms.size());
    run.launcher().signal(SIGKILL);
    EXPECT_EQ(run.end(), 128 + SIGKILL);
    EXPECT_TRUE(wait_until([&] { return nodes_alive(run.base_port()).empty(); }));
}

// Some nodes have not yet asked the system for the signal that ends them with the launcher.
TEST(Signals, ALauncherThatIsKilledWhileItStartsItsNodesLeavesNoneBehind) {
    for (int i = 0; i < 6; ++i) {
        SessionFile session = SessionFile::endless();
        RealRun run(session);
        while (nodes_alive(run.base_port()).empty() && !run.launcher().poll()) std::this_thread::yield();
        run.launcher().signal(SIGKILL);
        EXPECT_EQ(run.end(), 128 + SIGKILL);
        EXPECT_TRUE(
            wait_until([&] { return nodes_alive(run.base_port()).empty(); }, std::chrono::seconds{5}));
        for (const char* program : kNodePrograms) {
            for (const pid_t left : node_pids(run.base_port(), program)) kill(left, SIGKILL);
        }
    }
}

TEST(Signals, TerminatedNodesLeaveInOrder) {
    for (const char* program : kNodePrograms) {
        LoneNode node(program);
        ASSERT_TRUE(node.ready()) << node.words();
        EXPECT_EQ(node.terminate(), 0) << node.words();
        EXPECT_EQ(node.report().at("program"), program);
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
    SessionFile session;
    session.more = kNoMissAllowed;
    RealRun run(session, {"--strict-rt"});
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    freeze(run.node("thimble-master"), kFreeze);
    expect_end(run, 4, EndReason::kCompleted, "deadlines missed");
    EXPECT_GT(run.report("thimble-master").at("samples_skipped"), 0);
}

}  // namespace
}  // namespace thimble
