// thimble run --clock lock-step --step: real programs, stepped by lines from a pipe or a file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr const char* kShort =
    "[session]\nmodalities = ['HF']\ndelays_s = [0.05]\n[trial]\ncontact_hold_s = 0.3\n";

class StepThrough : public testing::Test {
  protected:
    Child start(const std::string& text) const {
        const auto run = words_in(fmt::format("run {} --clock lock-step --step --out {} --base-port {}",
                                              folder_.write("session.toml", text).string(),
                                              (folder_ / "out").string(), ports_.base()));
        return {built_programs() / "thimble", run, folder_ / "words", {typing_.input()}};
    }
    std::string words() const { return read_text(folder_ / "words"); }
    bool says(const std::string& text) const {
        return wait_until([&] { return words().find(text) != std::string::npos; });
    }
    TrialRow only_row() const {
        const auto rows = read_trial_table(folder_ / "out/trials.csv");
        EXPECT_EQ(rows.size(), 1U) << words();
        return rows.empty() ? TrialRow{} : rows.front();
    }

    const Folder folder_;
    const PortBlock ports_;
    const Typing typing_;
};

TEST_F(StepThrough, ChangesNoByteAndNamesEachProgramsPid) {
    Child child = start(kShort);
    ASSERT_TRUE(says("step> "));
    for (const char* program : kNodePrograms) {
        const auto pids = node_pids(ports_.base(), program);
        ASSERT_EQ(pids.size(), 1U) << program;
        EXPECT_THAT(words(), HasSubstr(fmt::format("pid {} ", pids.front()))) << program;
    }
    typing_.type("\n\n1.5\nc\n");
    EXPECT_EQ(child.wait(2 * kPatience), 0) << words();
    EXPECT_THAT(words(), HasSubstr(", is next"));
    EXPECT_THAT(words(), HasSubstr("at 1.5"));
    const auto in_virtual_time =
        words_in(fmt::format("run {} --clock virtual --out {}", (folder_ / "session.toml").string(),
                             (folder_ / "plain").string()));
    ASSERT_EQ(run_thimble(in_virtual_time).code, 0);
    EXPECT_EQ(whole_text(folder_ / "out/trials.csv"), read_text(folder_ / "plain/trials.csv"));
    const std::string trajectory = "trajectories/trial01_HF_50ms.csv";
    EXPECT_EQ(whole_text(folder_ / "out" / trajectory), read_text(folder_ / "plain" / trajectory));
}

TEST_F(StepThrough, EndsWithQAsWithCtrlC) {
    Child child = start(kShort);
    typing_.type("0.5\nq\n");
    EXPECT_EQ(child.wait(kPatience), 1);
    EXPECT_THAT(words(), HasSubstr("interrupted; finished trials are kept"));
    EXPECT_EQ(only_row().reason, EndReason::kInterrupted);
    EXPECT_THAT(nodes_alive(ports_.base()), testing::IsEmpty());
}

TEST_F(StepThrough, IsOfLockStepAlone) {
    const std::string file = folder_.write("session.toml", kShort).string();
    for (const char* clock : {"wall", "virtual"}) {
        const Outcome outcome = run_thimble({"run", file, "--clock", clock, "--step"});
        EXPECT_EQ(outcome.code, 2);
        EXPECT_THAT(outcome.words, HasSubstr("--step needs --clock lock-step"));
    }
}

// The stop waits at the door while the run pauses.
TEST_F(StepThrough, HearsAStopFromAnotherProgram) {
    // The second delay does not begin: only_row().
    Child child = start(
        fmt::format("[session]\nmodalities = ['HF']\ndelays_s = [0.0, 0.01]\n[trial]\ncontact_hold_s = {}\n"
                    "timeout_s = {}\n",
                    kEndlessInLockStep_s, 2 * kEndlessInLockStep_s));
    typing_.type("0.5\n");
    ASSERT_TRUE(says("at 0.5"));
    Child stop(built_programs() / "thimble",
               words_in(fmt::format("stop --base-port {}", ports_.base()), {"--reason", "cable loose"}),
               folder_ / "stop");
    typing_.type("c\n");
    EXPECT_EQ(child.wait(kPatience), 1) << words();
    EXPECT_THAT(words(), HasSubstr("cable loose"));
    EXPECT_EQ(only_row().reason, EndReason::kEmergencyStop);
    EXPECT_EQ(stop.wait(kPatience), 3) << read_text(folder_ / "stop");  // any user could answer so
    EXPECT_THAT(read_text(folder_ / "stop"), HasSubstr("only without a key (a lock-step run?), by session"));
    EXPECT_FALSE(has_user_key()) << "a stop waits for no disk";
}

}  // namespace
}  // namespace thimble
