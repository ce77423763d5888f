// A controller of the user in the real programs: the same bytes as in virtual time, and a fault that is named.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/runtime/plugin_watch.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class PluginRun : public testing::Test {
  protected:
    Outcome run(const std::string& plugin, const std::string& keys, const std::string& clock,
                const std::string& trial = "contact_hold_s = 0.3") const {
        folder_.write(
            "session.toml",
            fmt::format("[session]\nmodalities = ['HF']\ndelays_s = [0.05]\n[trial]\npeer_wait_s = 60\n{}\n"
                        "[control]\nplugin = '{}'\n[control.plugin_settings]\n{}\n",
                        trial, plugin, keys));
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

TEST_F(PluginRun, LockStepAndVirtualTimeGiveTheSameBytesAlsoOfOneInPython) {
    const auto run_mine = [this](const char* plugin, const char* clock) {
        const Outcome outcome = run(plugin, "trust_s = 0.005", clock);
        ASSERT_EQ(outcome.code, 0) << outcome.words;
    };
    run_mine(THIMBLE_PLUGINS "/mine.so", "virtual");
    for (const char* plugin :
         {THIMBLE_PLUGINS "/mine.so", THIMBLE_SOURCE_DIR "/examples/controller/mine.py"}) {
        std::filesystem::remove_all(folder_ / "lock-step");
        run_mine(plugin, "lock-step");
        EXPECT_EQ(result("lock-step", "trials.csv"), result("virtual", "trials.csv")) << plugin;
    }
    const auto rows = read_trial_table(folder_ / "virtual/trials.csv");
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].conditions.compensator, Compensator::kPlugin);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
}

TEST_F(PluginRun, OneThatCrashesIsNamed) {
    const Outcome outcome = run(THIMBLE_PLUGINS "/bad.so", "fault_number = 1", "lock-step");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.words, HasSubstr("thimble-master ended"));
    // A sanitizer's report follows, which pushes the line out of the last words.
    EXPECT_THAT(result("lock-step", "nodes/thimble-master_50ms.log"),
                HasSubstr("bad.so: crashed in sample()"));
}

// Zero force, the trial's end and the name.
TEST_F(PluginRun, OneThatDoesNotComeBackIsNamed) {
    for (const char* clock : {"wall", "lock-step"}) {
        const Outcome outcome = run(THIMBLE_PLUGINS "/bad.so", "fault_number = 3", clock);
        EXPECT_EQ(outcome.code, 1) << clock;
        EXPECT_THAT(outcome.words, HasSubstr("thimble-master ended")) << clock;
        EXPECT_THAT(outcome.words, HasSubstr("bad.so: did not return from force()")) << clock;
    }
}

// There is no other program to end.
TEST_F(PluginRun, OneThatDoesNotComeBackEndsVirtualTimeAsWell) {
    const Outcome outcome = run(THIMBLE_PLUGINS "/bad.so", "fault_number = 3", "virtual");
    EXPECT_EQ(outcome.code, kPluginHung);
    EXPECT_THAT(outcome.words, HasSubstr("bad.so: did not return from force()"));
}

// In lock-step this takes too long for a test.
TEST_F(PluginRun, OneThatIsNotMadeIsNamed) {
    const Outcome outcome = run(THIMBLE_PLUGINS "/bad.so", "fault_number = 18", "wall");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.words, HasSubstr("bad.so: did not return from create()"));
}

// The trial is as short as a session may set it: the test is about the end of the program.
TEST_F(PluginRun, OneThatDoesNotEndIsNamed) {
    for (const char* clock : {"wall", "lock-step"}) {
        const Outcome outcome = run(THIMBLE_PLUGINS "/bad.so", "fault_number = 19", clock, "timeout_s = 1");
        EXPECT_EQ(outcome.code, 1) << clock;
        EXPECT_THAT(outcome.words, HasSubstr("bad.so: did not return from destroy()")) << clock;
        EXPECT_THAT(result(clock, "trials.csv"), HasSubstr("timeout")) << clock;
    }
}

// The only trial of a participant's session.
TEST_F(PluginRun, OneThatDoesNotEndAfterAParticipantIsNamed) {
    const Outcome outcome =
        run(THIMBLE_PLUGINS "/bad.so", "fault_number = 19", "wall",
            "timeout_s = 1\n[protocol]\nexperiments = [3]\ntrials_per_modality = 1\npractice_trials = 0\n"
            "repeat_timeouts = false");
    EXPECT_EQ(outcome.code, 1) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("bad.so: did not return from destroy()"));
}

TEST_F(PluginRun, OneOfAnotherVersionIsRefused) {
    const Outcome outcome = run(THIMBLE_PLUGINS "/bad_abi.so", "", "virtual");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.words, HasSubstr("version 99"));
}

}  // namespace
}  // namespace thimble
