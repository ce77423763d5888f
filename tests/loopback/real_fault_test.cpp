// Real programs that are killed or stopped at random instants, and stopped on purpose. How many: THIMBLE_FAULT_TRIALS
// (docs/reliability.md).
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sys/resource.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

#if defined(__has_feature)
#if __has_feature(undefined_behavior_sanitizer) || __has_feature(address_sanitizer)
#define THIMBLE_SANITIZER_NEEDS_DESCRIPTORS
#endif
#endif
#ifdef THIMBLE_SANITIZER_NEEDS_DESCRIPTORS
constexpr bool kSanitizerNeedsDescriptors = true;
#else
constexpr bool kSanitizerNeedsDescriptors = false;
#endif
constexpr const char* kWhyNot =
    "this sanitizer looks at objects through pipes, for which there are no descriptors left";

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;

struct RealFault {
    const char* program;
    int signal;
    bool goes_on;  // SIGSTOP, and after 200 ms SIGCONT: less than the silence that ends a trial
    Duration after;
};

RealFault draw_fault(std::uint32_t number) {
    RandomStream stream({815, 0, 0, number, Purpose::kInstance});
    const auto program = static_cast<std::size_t>(stream.uniform() * kNodePrograms.size());
    const double kind = stream.uniform();
    return {kNodePrograms.at(std::min(program, kNodePrograms.size() - 1)), kind < 0.5 ? SIGKILL : SIGSTOP,
            kind > 0.75, from_seconds(0.3 * stream.uniform())};
}

void expect_clean_end(RealRun& run, bool lost) {
    EXPECT_EQ(run.end(), lost ? 3 : 0) << run.words();
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U) << "the trial has its row";
    EXPECT_EQ(rows.front().reason, lost ? EndReason::kPeerLost : EndReason::kCompleted);
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

TEST(RealFaults, AtRandomInstants) {
    const char* wanted = std::getenv("THIMBLE_FAULT_TRIALS");
    const auto trials = static_cast<std::uint32_t>(wanted == nullptr ? 1 : std::atoi(wanted));
    for (std::uint32_t number = 1; number <= trials; ++number) {
        const RealFault fault = draw_fault(number);
        SCOPED_TRACE(std::string(fault.program) + (fault.signal == SIGKILL ? " killed" : " stopped") +
                     (fault.goes_on ? " for 200 ms" : ""));
        SessionFile session;
        if (!fault.goes_on) session.contact_hold_s = kEndlessHold_s;
        RealRun run(session);
        ASSERT_TRUE(run.reaches_trial()) << run.words();
        std::this_thread::sleep_for(fault.after);
        const pid_t pid = run.node(fault.program);
        kill(pid, fault.signal);
        if (fault.goes_on) {
            std::this_thread::sleep_for(milliseconds{200});
            kill(pid, SIGCONT);
        }
        expect_clean_end(run, !fault.goes_on);
        if (HasFailure()) return;
    }
}

// Nothing to open a socket with: said in words, with the exit code of the network, and nothing hangs.
TEST(RealFaults, OutOfFileDescriptors) {
    if (kSanitizerNeedsDescriptors) GTEST_SKIP() << kWhyNot;
    for (const char* program : {"thimble-master", "thimble-slave-sim"}) {
        const std::string command = "ulimit -n 6; exec " + (built_programs() / program).string();
        const Outcome outcome = run_to_end("/bin/sh", {"-c", command});
        EXPECT_EQ(outcome.code, 3) << outcome.words;
        EXPECT_THAT(outcome.words, HasSubstr("cannot open a UDP socket"));
    }
}

// From here on whatever these programs want to open is refused; what is open stays open.
void take_descriptors(pid_t pid) {
    const rlimit none{3, 3};
    ASSERT_EQ(prlimit(pid, RLIMIT_NOFILE, &none, nullptr), 0) << std::strerror(errno);
}

// A node opens nothing while it runs: the trial goes on to its end. What it cannot write then, its report, is told.
TEST(RealFaults, NodesOutOfFileDescriptorsInARunKeepTheTrial) {
    if (kSanitizerNeedsDescriptors) GTEST_SKIP() << kWhyNot;
    RealRun run(SessionFile{});
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    for (const char* program : kNodePrograms) take_descriptors(run.node(program));
    run.end();
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U) << run.words();
    EXPECT_EQ(rows.front().reason, EndReason::kCompleted);
    EXPECT_THAT(read_text(run.out() / "nodes/thimble-slave-sim_0ms.log"), HasSubstr("ulimit -n"));
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

// thimble opens files between trials: the running one is kept, the run ends in words.
TEST(RealFaults, ASessionOutOfFileDescriptorsInARunLosesNoTrial) {
    if (kSanitizerNeedsDescriptors) GTEST_SKIP() << kWhyNot;
    SessionFile file;
    file.modalities = R"(["HF", "CF"])";
    RealRun run(file);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    take_descriptors(run.launcher().pid());
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("ulimit -n"));
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U) << run.words();
    EXPECT_EQ(rows.front().reason, EndReason::kCompleted);
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

// The guard of a session file is the one before the real program's handle.
TEST(Guard, TripsInTheRealProgramAsTheSessionFileSays) {
    SessionFile session;
    session.delays_s = "[0.05]";
    session.contact_hold_s = kEndlessHold_s;
    session.more = "[guard]\nenergy_limit_J = 0.001\n";
    RealRun run(session);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("[guard] energy_limit_J is 0.001"));
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.front().reason, EndReason::kSafetyStop);
}

TEST(EmergencyStop, ByTheCommandOfAnotherTerminal) {
    SessionFile session;
    session.contact_hold_s = kEndlessHold_s;
    RealRun run(session);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const Outcome stop =
        run_to_end(built_programs() / "thimble", {"stop", "--base-port", std::to_string(run.base_port()),
                                                  "--lanes", "1", "--reason", "a cable came loose"});
    EXPECT_EQ(stop.code, 0) << stop.words;
    EXPECT_THAT(stop.words, HasSubstr("thimble stop --release"));
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("a cable came loose"));
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.front().reason, EndReason::kEmergencyStop);
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
    // It holds for the next session on these ports, until it is released on purpose.
    const std::string port = std::to_string(run.base_port());
    const Outcome refused = run_to_end(built_programs() / "thimble",
                                       {"run", (run.out().parent_path() / "session.toml").string(),
                                        "--base-port", port, "--out", (run.out() / "again").string()});
    EXPECT_EQ(refused.code, 1) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("a cable came loose"));
    EXPECT_THAT(refused.words, HasSubstr("thimble stop --release --base-port " + port));
    const std::filesystem::path stops = std::getenv("THIMBLE_STOP_DIR");
    EXPECT_FALSE(std::filesystem::is_empty(stops));
    const Outcome released =
        run_to_end(built_programs() / "thimble", {"stop", "--release", "--base-port", port, "--lanes", "1"});
    EXPECT_EQ(released.code, 0) << released.words;
    EXPECT_THAT(released.words, HasSubstr("a cable came loose"));
    EXPECT_TRUE(std::filesystem::is_empty(stops));
}

// Ctrl-\ in thimble's terminal; to a node as well, which then tells the others.
TEST(EmergencyStop, BySignalToANode) {
    SessionFile session;
    session.contact_hold_s = kEndlessHold_s;
    RealRun run(session);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    kill(run.node("thimble-cutaneous"), SIGQUIT);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("SIGQUIT"));
    ASSERT_EQ(run.rows().size(), 1U);
    EXPECT_EQ(run.rows().front().reason, EndReason::kEmergencyStop);
}

}  // namespace
}  // namespace thimble
