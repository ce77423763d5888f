// Where --step pauses, on a session in virtual time.
#include "thimble/commands/step_prompt.hpp"

#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/virtual/virtual_session.hpp"
#include "tests/unit/participant/written_lines.hpp"
#include "thimble/commands/run.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

// A trial with these answers: what was said, and when each pause was.
class Steps : public testing::Test {
  protected:
    void run(const std::deque<std::string>& lines, int trials = 1) {
        StepPrompt prompt(std::make_unique<WrittenLines>(lines),
                          [this](const std::string& text) { said_ += text; });
        for (int trial = 0; trial < trials; ++trial) {
            PausedSession paused(std::make_unique<VirtualSession>(settings_), prompt);
            paused.start(run_trials_of(settings_, 0).front());
            const std::size_t before = said_.size();
            while (paused.now() < SessionTime{milliseconds{300}} && paused.step()) note(paused.now());
            said_in_last_ = said_.substr(before);
        }
    }
    void note(SessionTime now) {
        if (pauses() != known_) at_.push_back(now);
        known_ = pauses();
    }
    std::size_t pauses() const {
        std::size_t count = 0;
        for (std::size_t at = said_.find("trial 1"); at != std::string::npos;
             at = said_.find("trial 1", at + 1))
            ++count;
        return count;
    }

    const SystemSettings settings_ = load_system_settings("");
    std::string said_, said_in_last_;
    std::vector<SessionTime> at_;  // after the instant behind each pause
    std::size_t known_ = 0;
};

TEST(ParseStep, KnowsEachRequest) {
    EXPECT_EQ(parse_step("").kind, StepKind::kNext);
    EXPECT_EQ(parse_step(" ").kind, StepKind::kNext);
    EXPECT_EQ(parse_step("c").kind, StepKind::kToEnd);
    EXPECT_EQ(parse_step(" q ").kind, StepKind::kQuit);
    for (const char* text : {"50ms", "50 ms", "0.05"}) {
        EXPECT_EQ(parse_step(text).kind, StepKind::kFor) << text;
        EXPECT_EQ(parse_step(text).duration, milliseconds{50}) << text;
    }
    for (const char* text : {"0", "-1", "nan", "inf", "1e9", "5 parsecs", "cc", "1 2"})
        EXPECT_EQ(parse_step(text).kind, StepKind::kUnknown) << text;
}

TEST_F(Steps, EnterIsOneInstantAndADurationManyUntilTheLinesEnd) {
    run({"", "", "100ms"});
    EXPECT_EQ(pauses(), 4U);
    ASSERT_EQ(at_.size(), 4U);
    EXPECT_LT(at_[1], SessionTime{milliseconds{10}});
    EXPECT_GE(at_[3], SessionTime{milliseconds{100}});
    EXPECT_LT(at_[3], SessionTime{milliseconds{110}});
}

TEST_F(Steps, EachTrialPausesAtItsStartUntilOneGoesToTheEnd) {
    run({"10", "c"}, 3);
    EXPECT_EQ(pauses(), 2U);
    EXPECT_EQ(said_in_last_, "");
}

TEST_F(Steps, AWordThatIsNoRequestIsAskedAgain) {
    run({"help", "c"});
    EXPECT_EQ(pauses(), 1U);
    EXPECT_THAT(said_, HasSubstr(kStepHelp));
}

TEST_F(Steps, APauseSaysWhereNeedleAndForceAre) {
    run({"200ms", "c"});
    EXPECT_THAT(said_, HasSubstr("trial 1, 0 ms HF, at 0.000000 s: slave_sim has not answered yet"));
    EXPECT_THAT(said_, HasSubstr("at 0.2"));
    EXPECT_THAT(said_, testing::ContainsRegex("needle [-0-9.]+ mm, force [-0-9.]+ N"));
}

}  // namespace
}  // namespace thimble
