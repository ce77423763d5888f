// A plug-in in sessions of virtual time: it acts, and one that fails costs its own trial.
#include <array>
#include <atomic>
#include <cstdlib>
#include <poll.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "common/control/controller_ends.hpp"
#include "common/process/isolated.hpp"
#include "common/process/sandbox.hpp"
#include "session/records/trial_table.hpp"
#include "session/virtual/energy_demand.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/board/board_row.hpp"
#include "study/compensators/compensator_study.hpp"
#include "study/with_compensator.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"
#include "tests/unit/plugin/plugins.hpp"

namespace thimble::test {
namespace {

using testing::HasSubstr;

TrialRecord trial_with(const ControlSettings& control, Modality modality = Modality::kHF) {
    return run_virtual_trial(with_control(paper(), control), trial_of(modality, kPaperDelay));
}

TEST(PluginSession, TheExampleActsAndIsNamed) {
    const TrialRecord record = trial_with(control_of("mine")), again = trial_with(control_of("mine"));
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    EXPECT_EQ(record.conditions.compensator, Compensator::kPlugin);
    EXPECT_TRUE(same_samples(record, again));
    EXPECT_FALSE(same_samples(record, trial_with({})));
    EXPECT_TRUE(same_samples(trial_with(control_of("mine"), Modality::kCF), trial_with({}, Modality::kCF)));
}

TEST(PluginSession, OneThatFailsCostsItsOwnTrial) {
    const TrialRecord crashed = trial_with(bad(Fault::kCrash));
    EXPECT_EQ(crashed.reason, EndReason::kDeviceFault);
    EXPECT_THAT(crashed.fault, HasSubstr("bad.so: crashed in sample()"));
    EXPECT_THAT(trial_with(bad(Fault::kAbort)).fault, HasSubstr("crashed in sample()"));
    EXPECT_THAT(trial_with(bad(Fault::kLeave)).fault, HasSubstr("exit code 0"));
    EXPECT_THAT(trial_with(bad(Fault::kRefuse)).fault, HasSubstr("create()"));
    EXPECT_EQ(trial_with(control_of("mine")).reason, EndReason::kCompleted);
}

TEST(PluginSession, ATripOfTheGuardIsNamed) {
    SystemSettings settings = with_control(paper(), bad(Fault::kNone));
    settings.master.guard.energy_limit_J = 1e-6;
    const TrialRecord record = run_virtual_trial(settings, trial_of(Modality::kHF, kPaperDelay));
    EXPECT_EQ(outcome_text(record.reason, record.lost_peer), "safety_stop_master");
    EXPECT_THAT(record.fault, HasSubstr("[guard] energy_limit_J"));
    EXPECT_FALSE(record.samples.empty());
}

TEST(PluginSession, OneThatFailsEndsTheLookAtItsEnergyOnly) {
    SystemSettings settings = with_control(paper(), bad(Fault::kCrash));
    settings.handle.kind = HandleKind::kFalcon;
    settings.master.guard = guard_of_real_handle();
    EXPECT_THAT(refusal([&] { energy_warning(settings, {kPaperDelay}); }, ExitCode::kRunFailed),
                HasSubstr("bad.so: crashed in sample()"));
    settings.master.control = bad(Fault::kNone);
    EXPECT_GT(most_given_out_J(settings, kPaperDelay, 1), 0.5) << "it oscillates";
}

// The session goes on with 0 N, but the user hears of it.
TEST(PluginSession, OneThatGivesNoNumbersIsSaid) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    trial_with(bad(Fault::kNotANumber));
    spdlog::default_logger()->flush();
    const std::string said = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
    EXPECT_THAT(said, HasSubstr("bad.so returned"));
    EXPECT_THAT(said, HasSubstr("that are not numbers"));
    EXPECT_THROW(run_board_trial(with_control(paper(), bad(Fault::kNotANumber)), 1, 1), Error);
}

TEST(PluginSession, NeitherCtrlCNorAPrintDisturbsAPythonController) {
    const TemporaryDirectory folder;
    std::filesystem::copy(
        std::filesystem::path(THIMBLE_SOURCE_DIR) / "examples/controller/thimble_controller.py",
        folder / "thimble_controller.py");
    write_text(folder / "stopped.py",
               "import os, signal\nfrom thimble_controller import Controller, serve\n"
               "class Stopped(Controller):\n    def force(self, newest):\n"
               "        print('moving')\n        os.kill(os.getpid(), signal.SIGINT)\n        return 0.5\n"
               "if __name__ == '__main__':\n    serve(Stopped)\n");
    HandleEnd end(control_by(folder / "stopped.py"), {});
    end.start({});
    EXPECT_EQ(end.force_N(), 0.5);
    EXPECT_EQ(end.force_N(), 0.5);
}

TEST(PluginSession, APythonFileThatOnlyPrintsIsNoController) {
    const TemporaryDirectory folder;
    for (const char* words : {"print('hi')\n", "print('hi\\na\\tb')\n", ""}) {
        write_text(folder / "prints.py", words);
        EXPECT_THAT(refusal([&] { control_by(folder / "prints.py"); }, ExitCode::kUsage),
                    HasSubstr("must call serve()"));
    }
}

TEST(PluginSession, APythonControllerThatHangsIsEnded) {
    const TemporaryDirectory folder;
    write_text(folder / "hangs.py",
               "import sys, time\n"
               "if sys.argv[1] == '--describe':\n    print('thimble controller 1\\nhangs')\n    sys.exit()\n"
               "sys.stdin.buffer.read(112)\nsys.stdout.buffer.write(bytes(8))\nsys.stdout.flush()\n"
               "time.sleep(600)\n");
    { const HandleEnd end(control_by(folder / "hangs.py"), {}); }  // comes back
}

TEST(PluginSession, OneThatDoesNotComeBackIsEndedAndNamed) {
    const SystemSettings settings = with_control(paper(), bad(Fault::kHang));
    const IsolatedResult apart = run_isolated(
        [&] {
            VirtualSession session(settings);
            session.run(trial_of(Modality::kHF));
            return std::string();
        },
        std::chrono::milliseconds{500});
    EXPECT_FALSE(apart.bytes);
    EXPECT_THAT(apart.failure, HasSubstr("bad.so: did not return from force()"));
    EXPECT_THAT(apart.failure, HasSubstr("took longer than 0.5 s"));
}

TEST(PluginSession, AComparisonHasItsRow) {
    CompensatorStudyOptions options;
    options.networks = plain_networks({0.05});
    options.names = {"HF", "plugin"};
    options.subjects = 2;
    options.jobs = 2;
    const auto rows = run_compensator_study(with_control(paper(), control_of("mine")), options);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[1].name, "plugin");
    EXPECT_EQ(rows[1].completed, 2U);
    const auto failed = run_compensator_study(with_control(paper(), bad(Fault::kCrash)), options);
    EXPECT_EQ(failed[1].completed, 0U);
    EXPECT_EQ(failed[0].oscillation_peak_to_peak_m, rows[0].oscillation_peak_to_peak_m);
    EXPECT_THROW(run_compensator_study(paper(), options), Error);
}

TEST(PluginSession, OneWithTwoEndsDoesNotGoWithACodec) {
    const TemporaryDirectory folder;
    std::filesystem::copy(plugin_file("two_ends"), folder / "two.so");
    const auto load = [&](const std::string& codec) {
        write_text(folder / "session.toml", "[control]\nplugin = 'two.so'\n[codec]\n" + codec);
        load_system_settings(folder / "session.toml", {});
    };
    EXPECT_NO_THROW(load(""));
    EXPECT_THAT(refusal([&] { load("force = 'every-nth'"); }, ExitCode::kUsage),
                HasSubstr("'codec.force' does not work with a plug-in that has two ends"));
}

TEST(Apart, BringsWhatTheWorkGivesOrWhyItFailed) {
    EXPECT_EQ(run_isolated([] { return std::string(300'000, 'x'); }).bytes, std::string(300'000, 'x'));
    const IsolatedResult thrown =
        run_isolated([]() -> std::string { throw Error(ExitCode::kData, "no such row"); });
    EXPECT_EQ(thrown.failure, "no such row");
}

// A program that the work has started ends with it.
TEST(Apart, OneThatIsEndedTakesAlongWhatItStarted) {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe(ends.data()), 0);
    run_isolated(
        []() -> std::string {
            if (fork() >= 0)
                for (;;) pause();
            return {};
        },
        std::chrono::milliseconds{50});
    close(ends[1]);
    char byte = 0;
    pollfd ready{ends[0], POLLIN, 0};
    EXPECT_EQ(poll(&ready, 1, 10'000), 1) << "somebody holds the pipe's other end";
    EXPECT_EQ(::read(ends[0], &byte, 1), 0);
    close(ends[0]);
}

// A child that another thread makes at the same time must not keep this one's answer waiting.
TEST(Apart, OneThatHangsCostsNoOtherItsAnswer) {
    std::atomic<bool> over = false;
    std::thread other([&] {
        while (!over)
            run_isolated(
                []() -> std::string {
                    for (;;) pause();
                },
                std::chrono::milliseconds{20});
    });
    for (int i = 0; i < 40; ++i)
        EXPECT_EQ(run_isolated([] { return std::string("good"); }, std::chrono::seconds{20}).bytes, "good");
    over = true;
    other.join();
}

// This test itself is the command: it starts again inside, and leaves there a file that the outer one finds.
TEST(Sandbox, TheSameCommandRunsInsideAndWritesWhereItMay) {
    constexpr const char* kFolder = "THIMBLE_TEST_FOLDER";
    if (in_sandbox()) {
        const std::filesystem::path folder(std::getenv(kFolder));
        std::string seen = std::filesystem::exists(std::getenv("THIMBLE_TEST_HIDDEN")) ? "" : "yes";
        if (!std::filesystem::exists(folder / "../shown/file")) seen = "no plug-in";
        std::ofstream(folder / "../elsewhere") << "no";
        std::ofstream(folder / "../shown/file2") << "no";
        write_text(folder / "inside", seen);
        return;
    }
    if (const std::string why = why_no_sandbox(); !why.empty()) GTEST_SKIP() << "package bubblewrap: " << why;
    const TemporaryDirectory folder;
    setenv(kFolder, (folder / "out").c_str(), 1);
    setenv("THIMBLE_SANDBOX", "1", 1);  // a variable of the environment opens nothing
    std::filesystem::create_directory(folder / "shown");
    write_text(folder / "shown/file", "");
    std::string hidden = "/tmp/thimble-hidden-XXXXXX";
    close(mkstemp(hidden.data()));
    setenv("THIMBLE_TEST_HIDDEN", hidden.c_str(), 1);
    run_isolated([&]() -> std::string {
        enter_sandbox({folder / "out"}, {folder / "shown"});
        return {};
    });
    std::filesystem::remove(hidden);
    EXPECT_EQ(read_text(folder / "out" / "inside"), "yes");
    EXPECT_FALSE(std::filesystem::exists(folder / "elsewhere"));
    EXPECT_FALSE(std::filesystem::exists(folder / "shown/file2"));
    EXPECT_THROW(enter_sandbox({folder / "out"}, {"/tmp"}), Error);
}

// The example in Python is the one in C, but for the order of rounding.
TEST(PluginSession, TheExampleInPythonActsAsTheOneInC) {
    const ControlSettings control = control_by(THIMBLE_SOURCE_DIR "/examples/controller/mine.py");
    EXPECT_EQ(control.plugin.values, control_of("mine").plugin.values);
    const TrialRecord record = trial_with(control);
    EXPECT_EQ(record.fault, "");
    EXPECT_TRUE(same_samples(record, trial_with(control_of("mine"))));
}

}  // namespace
}  // namespace thimble::test
