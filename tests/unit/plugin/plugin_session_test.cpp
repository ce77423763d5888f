// A plug-in in sessions of virtual time: it acts, and one that fails costs its own trial.
#include <atomic>
#include <cstdlib>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/apart.hpp"
#include "common/process/sandbox.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/compensators/compensator_study.hpp"
#include "study/with_compensator.hpp"
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

TEST(PluginSession, OneThatDoesNotComeBackIsEndedAndNamed) {
    const SystemSettings settings = with_control(paper(), bad(Fault::kHang));
    const ApartResult apart = run_apart(
        [&] {
            VirtualSession session(settings);
            session.run(trial_of(Modality::kHF));
            return std::string();
        },
        std::chrono::milliseconds{500});
    EXPECT_FALSE(apart.bytes);
    EXPECT_THAT(apart.failure, HasSubstr("bad.so: did not come back from force()"));
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

TEST(Apart, BringsWhatTheWorkGivesOrWhyItFailed) {
    EXPECT_EQ(run_apart([] { return std::string(300'000, 'x'); }).bytes, std::string(300'000, 'x'));
    const ApartResult thrown =
        run_apart([]() -> std::string { throw Error(ExitCode::kData, "no such row"); });
    EXPECT_EQ(thrown.failure, "no such row");
}

// A child that another thread makes at the same time must not keep this one's answer waiting.
TEST(Apart, OneThatHangsCostsNoOtherItsAnswer) {
    std::atomic<bool> over = false;
    std::thread other([&] {
        while (!over)
            run_apart(
                []() -> std::string {
                    for (;;) pause();
                },
                std::chrono::milliseconds{20});
    });
    for (int i = 0; i < 40; ++i)
        EXPECT_EQ(run_apart([] { return std::string("good"); }, std::chrono::seconds{20}).bytes, "good");
    over = true;
    other.join();
}

// This test itself is the command: it starts again inside, and leaves there a file that the outer one finds.
TEST(Sandbox, TheSameCommandRunsInsideAndWritesWhereItMay) {
    constexpr const char* kFolder = "THIMBLE_TEST_FOLDER";
    if (in_sandbox()) {
        const std::filesystem::path folder(std::getenv(kFolder));
        write_text(folder.parent_path() / "elsewhere", "no");
        if (!std::filesystem::exists(folder.parent_path() / "elsewhere"))
            write_text(folder / "inside", "yes");
        return;
    }
    if (const std::string why = why_no_sandbox(); !why.empty()) GTEST_SKIP() << "package bubblewrap: " << why;
    const TemporaryDirectory folder;
    setenv(kFolder, (folder / "out").c_str(), 1);
    run_apart([&]() -> std::string {
        enter_sandbox({folder / "out"});
        return {};
    });
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / "inside"));
}

// The example in Python is the one in C, but for the order of rounding.
TEST(PluginSession, TheExampleInPythonActsAsTheOneInC) {
    ControlSettings control;
    control.compensator = Compensator::kPlugin;
    control.plugin = load_plugin(std::filesystem::path(THIMBLE_SOURCE_DIR) / "examples/controller/mine.py");
    EXPECT_EQ(control.plugin.values, control_of("mine").plugin.values);
    const TrialRecord record = trial_with(control);
    EXPECT_EQ(record.fault, "");
    EXPECT_TRUE(same_samples(record, trial_with(control_of("mine"))));
}

}  // namespace
}  // namespace thimble::test
