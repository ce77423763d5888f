#include "visual_node/views/experimenter_model.hpp"

#include <gtest/gtest.h>

#include "tests/unit/views/played_session.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A running session that the model has just received.
struct ExperimenterBench : ModelBench<ExperimenterModel> {
    ExperimenterBench() {
        session.monitor.state = NodeState::kRunning;
        session.monitor.modality = Modality::kCCF;
        session.monitor.network_delay_s = 0.05;
        session.trial = 6;
        pass(4);
    }
};

TEST(ExperimenterModel, StartsTheModalityThatWasChosenElseTheSessions) {
    ExperimenterBench bench;
    EXPECT_EQ(bench.press(Command::kStart)->modality, Modality::kCCF);
    EXPECT_EQ(bench.press(Command::kVF), std::nullopt);  // choosing starts nothing in an experiment
    bench.pass(8);
    EXPECT_EQ(bench.model.chosen(), Modality::kVF);
    (void)bench.session.heard(bench.now);
    const auto start = bench.press(Command::kStart);
    EXPECT_EQ(start->kind, OrderKind::kStart);
    EXPECT_EQ(start->modality, Modality::kVF);
}

TEST(ExperimenterModel, DelayByPresetByStepAndBySlider) {
    ExperimenterBench bench;
    EXPECT_NEAR(bench.press(Command::kDelayUp)->value, 0.055, 1e-12);
    EXPECT_NEAR(bench.press(Command::kDelayUp)->value, 0.060, 1e-12);  // counts from what was asked
    bench.model.set_delay(bench.now, 7);
    EXPECT_EQ(bench.session.heard(bench.now).front().order.value, kDelayLimit_s);
    bench.model.set_delay(bench.now, 0);
    (void)bench.session.heard(bench.now);
    EXPECT_EQ(bench.press(Command::kDelayDown)->value, 0);
}

TEST(ExperimenterModel, ANetworkIsAskedByNameUntilItHoldsWithItsDelay) {
    ExperimenterBench bench;
    const auto geo = bench.press(Command::kNetwork5);
    ASSERT_TRUE(geo);
    EXPECT_EQ(geo->kind, OrderKind::kNetwork);
    EXPECT_EQ(geo->network.view(), "geo");
    EXPECT_TRUE(bench.model.link().holds(Command::kNetwork5));  // as it was asked
    EXPECT_EQ(bench.model.link().delay_s(), 0.3);
    bench.session.monitor.network = *NetworkName::of("geo");
    bench.pass(200);
    EXPECT_FALSE(bench.session.heard(bench.now).empty());  // its name alone is not enough
    bench.session.monitor.network_delay_s = 0.3;
    bench.pass(60);
    (void)bench.session.heard(bench.now);
    bench.pass(200);
    EXPECT_TRUE(bench.session.heard(bench.now).empty());
    bench.session.monitor.network_delay_s = 0.1;  // the user has moved the slider
    bench.pass(8);
    EXPECT_FALSE(bench.model.link().holds(Command::kNetwork5));
}

TEST(ExperimenterModel, TheSliderCallsOffANetworkThatIsStillAsked) {
    ExperimenterBench bench;
    bench.press(Command::kNetwork5);
    bench.model.set_delay(bench.now, 0.2);
    (void)bench.session.heard(bench.now);
    bench.pass(200);
    const auto all = bench.session.heard(bench.now);
    ASSERT_GE(all.size(), 3U);
    for (const HeardOrder& heard : all) EXPECT_EQ(heard.order.kind, OrderKind::kDelay);
    EXPECT_EQ(bench.model.link().delay_s(), 0.2);
}

TEST(ExperimenterModel, PauseIsResumeWhereItIsPaused) {
    ExperimenterBench bench;
    EXPECT_EQ(bench.press(Command::kPause)->kind, OrderKind::kPause);
    bench.session.monitor.paused = true;
    bench.pass(100);
    (void)bench.session.heard(bench.now);
    EXPECT_EQ(bench.press(Command::kPause)->kind, OrderKind::kResume);
}

TEST(ExperimenterModel, ExcludingAsksFirst) {
    ExperimenterBench bench;
    EXPECT_EQ(bench.press(Command::kYes), std::nullopt);
    EXPECT_EQ(bench.press(Command::kExclude), std::nullopt);
    EXPECT_EQ(bench.model.question(), 6U);
    EXPECT_EQ(bench.press(Command::kNo), std::nullopt);
    EXPECT_EQ(bench.model.question(), std::nullopt);
    EXPECT_EQ(bench.press(Command::kExclude), std::nullopt);
    bench.session.trial = 7;  // the next trial has begun while the question stood: it is still about 6
    bench.pass(8);
    const auto exclude = bench.press(Command::kYes);
    ASSERT_TRUE(exclude);
    EXPECT_EQ(exclude->kind, OrderKind::kExclude);
    EXPECT_EQ(exclude->trial, 6U);
    EXPECT_EQ(bench.model.question(), std::nullopt);
    bench.pass(400);
    EXPECT_EQ(bench.model.notice().view(), "exclude of trial 6: sent, see the session's log for the answer");
}

TEST(ExperimenterModel, WithoutATrialNothingIsRepeatedOrExcluded) {
    ExperimenterBench bench;
    bench.session.trial = 0;
    bench.pass(8);
    EXPECT_EQ(bench.press(Command::kRepeat), std::nullopt);
    EXPECT_EQ(bench.press(Command::kExclude), std::nullopt);
    EXPECT_EQ(bench.model.question(), std::nullopt);
    EXPECT_TRUE(bench.model.notice().view().empty());
}

TEST(ExperimenterModel, AlarmsForSilenceAndForOrdersWithoutAnswer) {
    ExperimenterBench bench;
    EXPECT_TRUE(bench.model.link().alarm(bench.now).view().empty());
    bench.model.press(bench.now, Command::kPause);
    bench.pass(2100);
    EXPECT_NE(bench.model.link().alarm(bench.now).view().find("does not answer: 'pause'"), std::string::npos);
    ExperimenterBench unknown;
    unknown.press(Command::kNetwork1);
    unknown.pass(2100);
    EXPECT_NE(unknown.model.link().alarm(unknown.now).view().find("has not set the network 'wifi'"),
              std::string::npos);
    const SessionTime later = bench.now + milliseconds{700};
    bench.model.update(later);
    EXPECT_NE(bench.model.link().alarm(later).view().find("No message from the session for 700 ms."),
              std::string::npos);
    PlayedViewSession nobody;
    const ExperimenterModel alone(1, nobody.channels());
    EXPECT_NE(alone.link().alarm(later).view().find("Waiting for the session's first message"),
              std::string::npos);
}

}  // namespace
}  // namespace thimble
