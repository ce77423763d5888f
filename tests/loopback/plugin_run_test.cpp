// A controller of the user in the real programs: the same bytes as in virtual time, and a fault that is named.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class PluginRun : public testing::Test {
  protected:
    Outcome run(const std::string& plugin, const std::string& keys, const std::string& clock) const {
        folder_.write(
            "session.toml",
            fmt::format("[session]\nmodalities = ['HF']\ndelays_s = [0.05]\n[trial]\ncontact_hold_s = 0.3\n"
                        "[control]\nplugin = '{}'\n[control.plugin_settings]\n{}\n",
                        plugin, keys));
        return run_thimble(words_in(fmt::format("run {} --base-port {} --clock {} --out {}",
                                                (folder_ / "session.toml").string(), ports_.base(), clock,
                                                (folder_ / clock).string())));
    }
    std::string result(const std::string& clock, const std::string& file) const {
        return read_text(folder_ / clock / file);
    }

    const Folder folder_;
    const PortBlock ports_;
};

TEST_F(PluginRun, LockStepAndVirtualTimeGiveTheSameBytes) {
    for (const char* clock : {"lock-step", "virtual"}) {
        const Outcome outcome = run(THIMBLE_PLUGINS "/mine.so", "trust_s = 0.005", clock);
        ASSERT_EQ(outcome.code, 0) << outcome.words;
    }
    EXPECT_EQ(result("lock-step", "trials.csv"), result("virtual", "trials.csv"));
    const auto rows = read_trial_table(folder_ / "virtual/trials.csv");
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].conditions.compensator, Compensator::kPlugin);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
}

TEST_F(PluginRun, OneInPythonRunsInLockStep) {
    const Outcome outcome =
        run(THIMBLE_SOURCE_DIR "/examples/controller/mine.py", "trust_s = 0.005", "lock-step");
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    ASSERT_EQ(run(THIMBLE_PLUGINS "/mine.so", "trust_s = 0.005", "virtual").code, 0);
    EXPECT_EQ(result("lock-step", "trials.csv"), result("virtual", "trials.csv"));
}

TEST_F(PluginRun, OneThatCrashesIsNamed) {
    const Outcome outcome = run(THIMBLE_PLUGINS "/bad.so", "fault_number = 1", "lock-step");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.words, HasSubstr("bad.so: crashed in sample()"));
}

TEST_F(PluginRun, OneOfAnotherVersionIsRefused) {
    const Outcome outcome = run(THIMBLE_PLUGINS "/bad_abi.so", "", "virtual");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.words, HasSubstr("version 99"));
}

}  // namespace
}  // namespace thimble
