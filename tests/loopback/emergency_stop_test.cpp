// Emergency stops of real sessions: by command, signal and under a lab key, in a trial and before it, without a listener, and kept.
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <variant>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "common/stop_bus.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

Outcome thimble_stop(const std::vector<std::string>& more) {
    return run_thimble(words_in("stop --parallel-conditions 1", more));
}

TEST(EmergencyStop, ByTheCommandOfAnotherTerminal) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const std::string port = std::to_string(run.base_port());
    const Outcome stop = thimble_stop({"--base-port", port, "--reason", "a cable came loose"});
    EXPECT_EQ(stop.code, 0) << stop.words;
    EXPECT_THAT(stop.words, HasSubstr("confirmed by "));
    EXPECT_THAT(stop.words, HasSubstr("thimble stop --release --base-port " + port));
    expect_end(run, 1, EndReason::kEmergencyStop, "a cable came loose");
    // It holds for the next session on these ports, until it is released on purpose.
    const Outcome refused = run_thimble({"run", (run.out().parent_path() / "session.toml").string(),
                                         "--base-port", port, "--out", (run.out() / "again").string()});
    EXPECT_EQ(refused.code, 1) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("a cable came loose"));
    EXPECT_THAT(refused.words, HasSubstr("thimble stop --release --base-port " + port));
    const std::filesystem::path stops = std::getenv("THIMBLE_STOP_DIR");
    EXPECT_FALSE(std::filesystem::is_empty(stops));
    const Outcome released = thimble_stop({"--release", "--base-port", port});
    EXPECT_EQ(released.code, 0) << released.words;
    EXPECT_THAT(released.words, HasSubstr("a cable came loose"));
    EXPECT_THAT(released.words, HasSubstr("no running program answered"));
    EXPECT_TRUE(std::filesystem::is_empty(stops));
}

// Ctrl-\ in thimble's terminal; to a node as well, which then tells the others.
TEST(EmergencyStop, BySignalToANode) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    kill(run.node("thimble-cutaneous"), SIGQUIT);
    expect_end(run, 1, EndReason::kEmergencyStop, "SIGQUIT");
}

// Two conditions run side by side, each on ports of its own. A stop of thimble's terminal ends both, although it cannot be kept.
TEST(EmergencyStop, EndsTheConditionsThatRunAtTheSameTime) {
    SessionFile session = SessionFile::endless();
    session.delays_s = "[0.0, 0.05]";
    session.parallel_conditions = 2;
    RealRun run(session);
    const auto begun = [&](const char* delay) {
        const auto file = run.out() / "nodes" / (std::string("thimble-master_") + delay + ".log");
        return read_text(file).find("ready") != std::string::npos;
    };
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    ASSERT_TRUE(wait_until([&] { return begun("0ms") && begun("50ms"); })) << run.words();
    std::filesystem::remove(std::getenv("THIMBLE_STOP_DIR"));
    run.launcher().signal(SIGQUIT);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("ends with this program"));
    ASSERT_FALSE(run.rows().empty()) << run.words();
    for (const TrialRow& row : run.rows()) EXPECT_EQ(row.reason, EndReason::kEmergencyStop);
    EXPECT_THAT(nodes_alive(run.base_port()), testing::IsEmpty());
    EXPECT_THAT(nodes_alive(run.base_port() + static_cast<int>(Port::kCount)), testing::IsEmpty());
}

// Another user of the machine, or the answer of an earlier stop.
TEST(EmergencyStop, OnlyAnAnswerToThisStopAndUnderTheSessionsKeyConfirmsIt) {
    struct Case {
        const char* mode;
        std::uint64_t beside;  // the number of the stop that the answer names
        int code;
        const char* words;
    };
    for (const Case& one : {Case{"none", 0, 0, "confirmed by session (ports from "},
                            Case{"none", 1, 3, "no program confirmed the stop"},
                            Case{"user-key", 0, 3, "only without a key (a lock-step run?), by session"}}) {
        const Folder folder;
        const PortBlock ports;
        const auto file = folder.write("session.toml", fmt::format("[security]\nmode = '{}'\n", one.mode));
        UdpChannel bus(network_at(ports.base()).at(Port::kSessionStop), Endpoint{"127.0.0.1", 0});
        Child stop(built_programs() / "thimble",
                   words_in(fmt::format("stop {} --parallel-conditions 1 --base-port {}", file.string(),
                                        ports.base())),
                   folder / "words");
        Encoder encoder;
        EXPECT_TRUE(wait_until([&] {
            if (const auto heard = decode(bus.receive()).message) {
                auto order = std::get<StopOrder>(heard->body);
                const Header header{1, {}, 1, number_in_answer(order.id), Role::kSession};
                order.id += one.beside;
                order.kind = StopKind::kStop;
                bus.answer(encoder.encode(header, order));
            }
            return stop.poll().has_value();
        }));
        EXPECT_EQ(stop.poll(), one.code);
        EXPECT_THAT(read_text(folder / "words"), HasSubstr(one.words));
    }
}

// Without the session file there is no key, and no program hears.
TEST(EmergencyStop, UnderALabKeyTheSessionFileIsNamedAndWithoutItNobodyClaimsToHaveStopped) {
    const Folder folder;
    SessionFile session = SessionFile::endless();
    session.more = under_lab_key(folder / "lab.key");
    RealRun run(session);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const std::string port = std::to_string(run.base_port());
    const Outcome unheard = thimble_stop({"--base-port", port});
    EXPECT_EQ(unheard.code, 3) << unheard.words;
    EXPECT_THAT(unheard.words, HasSubstr("NOT been stopped"));
    EXPECT_FALSE(run.launcher().poll()) << "it runs on";
    const std::string file = (run.out().parent_path() / "session.toml").string();
    const Outcome stop = thimble_stop({file, "--base-port", port});
    EXPECT_EQ(stop.code, 0) << stop.words;
    EXPECT_THAT(stop.words, HasSubstr("--release " + file + " --base-port " + port));
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("--release " + file + " --base-port " + port));
}

// While the programs are started: no trial begins.
TEST(EmergencyStop, BeforeTheFirstTrial) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(wait_until([&] { return run.words().find("round trip") != std::string::npos; }))
        << run.words();
    run.launcher().signal(SIGQUIT);
    expect_end(run, 1, EndReason::kEmergencyStop, "Ctrl-\\");
    EXPECT_FALSE(std::filesystem::is_empty(std::getenv("THIMBLE_STOP_DIR")));
    if (!read_trajectory(run.trajectory_path(run.only_row().conditions)).samples.empty())
        GTEST_SKIP() << "this machine paused for so long that the trial had begun before the stop";
}

// One program waits for this test, and the conductor of lock-step waits for that program.
TEST(EmergencyStop, InLockStepWhileTheProgramsStart) {
    const Folder folder;
    install_programs(folder / "bin");
    const std::filesystem::path started = folder / "started", go_on = folder / "go_on";
    replace_program(
        folder / "bin" / "thimble-visual",
        fmt::format("touch {}\nuntil [ -e {} ]; do sleep 0.01; done\nexec {} \"$@\"\n", started.string(),
                    go_on.string(), (built_programs() / "thimble-visual").string()));
    RealRun run(SessionFile::endless(kEndlessInLockStep_s), kLockStep, folder / "bin");
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(started); })) << run.words();
    run.launcher().signal(SIGQUIT);
    folder.write("go_on", "");
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("Ctrl-\\"));
}

}  // namespace
}  // namespace thimble
