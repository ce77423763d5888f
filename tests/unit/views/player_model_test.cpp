#include "visual_node/views/player_model.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "tests/unit/views/played_session.hpp"

namespace thimble {
namespace {

using PlayerBench = ModelBench<PlayerModel>;

TEST(PlayerModel, AModalityStartsAtOnceAndSpaceStartsItAgain) {
    PlayerBench bench;
    bench.pass(4);
    const auto started = bench.press_all(Command::kVF);
    ASSERT_EQ(started.size(), 1U);
    EXPECT_EQ(started[0].order.kind, OrderKind::kStart);
    EXPECT_EQ(started[0].order.modality, Modality::kVF);
    EXPECT_EQ(bench.model.modality(), Modality::kVF);
    EXPECT_EQ(bench.press(Command::kStart)->modality, Modality::kVF);
    EXPECT_EQ(bench.press(Command::kNetwork2)->network.view(), "paper50");
    EXPECT_EQ(bench.press(Command::kPause)->kind, OrderKind::kPause);
    EXPECT_EQ(bench.press(Command::kEndTrial)->kind, OrderKind::kEndTrial);
    EXPECT_EQ(bench.press(Command::kExclude), std::nullopt);
}

TEST(PlayerModel, HintsFollowTheTrial) {
    PlayerBench bench;
    const auto hint = [&] {
        bench.pass(4);
        return std::string(bench.model.hint());
    };
    Monitor& monitor = bench.session.monitor;
    const std::vector<std::function<void()>> steps{
        [] {},
        [&] { monitor.state = NodeState::kRunning, monitor.position_fixture_m = 0.12; },
        [&] { monitor.phase = TissuePhase::kContact; },
        [&] { monitor.phase = TissuePhase::kPenetrated; },
        [&] { monitor.position_needle_m = 0.121; },
        [&] { monitor.network_delay_s = 0.05; },
        [&] { monitor.modality = Modality::kVF, monitor.beeped = true; },
        [&] { monitor.needle_held = true; }};
    std::set<std::string> hints;
    for (const auto& happen : steps) {
        happen();
        hints.insert(hint());
        const bool shakes = monitor.network_delay_s > 0 && monitor.modality == Modality::kHF;
        EXPECT_EQ(hint().find("does it shake") != std::string::npos, shakes);
    }
    EXPECT_EQ(hints.size(), steps.size());
}

TEST(PlayerModel, TheHintDoesNotFlipWhereTheNeedleOscillates) {
    PlayerBench bench;
    Monitor& monitor = bench.session.monitor;
    monitor.state = NodeState::kRunning;
    monitor.phase = TissuePhase::kPenetrated;
    monitor.position_fixture_m = 0.12;
    monitor.network_delay_s = 0.05;
    bench.model.set_hand(false);
    bench.pass(4);
    EXPECT_NE(std::string_view(bench.model.hint()).find("Click"), std::string_view::npos);
    bench.model.set_hand(true);
    std::set<std::string_view> hints;
    for (int ms = 0; ms < 6000; ms += 4) {  // at 1.4 and at 6 Hz
        const double half_ms = ms < 3000 ? 360 : 83;
        monitor.position_needle_m = std::fmod(ms, 2 * half_ms) < half_ms ? 0.124 : 0.073;
        bench.pass(4);
        hints.insert(bench.model.hint());
    }
    EXPECT_EQ(hints.size(), 1U);
    monitor.position_needle_m = 0.09;  // pulled back, and held there
    bench.pass(1300);
    EXPECT_NE(std::string_view(bench.model.hint()).find("inside"), std::string_view::npos);
}

TEST(PlayerModel, HintsNameTheHandThatMovesTheNeedle) {
    const std::array<std::pair<HandKind, std::string>, 3> words{
        {{HandKind::kMouse, "mouse"}, {HandKind::kKeyboard, "Hold"}, {HandKind::kDevice, "your device"}}};
    for (const auto& [kind, word] : words) {
        PlayerBench bench;
        bench.session.monitor.state = NodeState::kRunning;
        bench.session.monitor.position_fixture_m = 0.12;
        for (const bool beeped : {false, true}) {
            bench.session.monitor.beeped = beeped;
            bench.model.set_hand(kind == HandKind::kDevice ? std::nullopt : std::optional(true), kind);
            bench.pass(4);
            EXPECT_NE(std::string_view(bench.model.hint()).find(word), std::string_view::npos) << word;
        }
    }
}

TEST(PlayerModel, TellsWhatToExpectOfEachModality) {
    for (const Modality modality : kModalities) {
        EXPECT_GT(std::string_view(key_of(player_keys(), command_of(modality)).help).size(), 30U);
    }
}

// A recorded trial of 10 s that stands still at 4 s, and obeys if it is asked to.
struct ReplayBench : PlayerBench {
    ReplayBench() {
        session.monitor.state = NodeState::kRunning;
        session.monitor.time_s = 4;
        session.monitor.paused = true;
        session.replay = ReplayState{};
        session.replay->duration_s = 10;
        pass(8);
    }
    Order first(Command command) { return press(command).value_or(Order{}); }
};

TEST(ReplayModel, StepsSeekFromWhereItStands) {
    const std::vector<std::pair<Command, double>> steps{{Command::kBack, 3.9},
                                                        {Command::kOn, 4.1},
                                                        {Command::kFarBack, 3},
                                                        {Command::kFarOn, 5},
                                                        {Command::kToBegin, 0},
                                                        {Command::kToEnd, 10},
                                                        {Command::kFrameOn, 4 + 1.0 / 60},
                                                        {Command::kFrameBack, 4 - 1.0 / 60}};
    for (const auto& [command, time_s] : steps) {
        ReplayBench bench;
        const Order order = bench.first(command);
        EXPECT_EQ(order.kind, OrderKind::kSeek);
        EXPECT_DOUBLE_EQ(order.value, time_s);
        EXPECT_DOUBLE_EQ(bench.model.replay().position_s(), time_s);  // shown before it is answered
    }
}

TEST(ReplayModel, StepsAddUpBeforeTheyAreAnsweredAndStayWithinTheTrial) {
    ReplayBench bench;
    bench.first(Command::kFarOn);
    EXPECT_DOUBLE_EQ(bench.first(Command::kFarOn).value, 6);
    for (int i = 0; i < 9; ++i) bench.first(Command::kFarOn);
    EXPECT_DOUBLE_EQ(bench.model.replay().position_s(), 10);
    bench.model.replay().seek(bench.now, -3);
    EXPECT_DOUBLE_EQ(bench.model.replay().position_s(), 0);
}

TEST(ReplayModel, ASmallStepIsRepeatedUntilItShows) {
    ReplayBench bench;
    bench.first(Command::kFrameOn);
    bench.pass(200);
    EXPECT_GE(bench.session.heard(bench.now).size(), 3U);  // 17 ms are not "nearly there"
    bench.session.monitor.time_s = 4 + kReplayFrame_s;
    bench.pass(60);
    EXPECT_TRUE(bench.press_all(Command::kYes).empty());
    bench.pass(200);
    EXPECT_TRUE(bench.session.heard(bench.now).empty());
}

TEST(ReplayModel, AFastReplayIsNotHeldAtTheSoughtPlace) {
    ReplayBench bench;
    bench.session.monitor.paused = false;
    bench.session.replay->speed = 5;
    bench.pass(8);
    bench.model.replay().seek(bench.now, 2);
    (void)bench.session.heard(bench.now);
    bench.session.monitor.time_s = 2.6;  // it has gone on since
    bench.pass(200);
    EXPECT_TRUE(bench.session.heard(bench.now).empty());
}

TEST(ReplayModel, AFrameStandsStillFirst) {
    ReplayBench bench;
    bench.session.monitor.paused = false;
    bench.pass(8);
    const auto heard = bench.press_all(Command::kFrameOn);
    ASSERT_EQ(heard.size(), 2U);
    EXPECT_EQ(heard[0].order.kind, OrderKind::kPause);
    EXPECT_EQ(heard[1].order.kind, OrderKind::kSeek);
    EXPECT_TRUE(bench.model.replay().paused());
}

TEST(ReplayModel, PlayPausesGoesOnAndBeginsAnewAtTheEnd) {
    ReplayBench bench;
    EXPECT_EQ(bench.first(Command::kPlayPause).kind, OrderKind::kResume);
    bench.session.monitor.paused = false;
    bench.pass(100);
    EXPECT_EQ(bench.first(Command::kPlayPause).kind, OrderKind::kPause);
    bench.session.monitor.paused = true;
    bench.session.monitor.time_s = 10;
    bench.pass(100);
    const auto heard = bench.press_all(Command::kPlayPause);
    ASSERT_EQ(heard.size(), 2U);
    EXPECT_EQ(heard[0].order.kind, OrderKind::kSeek);
    EXPECT_EQ(heard[0].order.value, 0);
    EXPECT_EQ(heard[1].order.kind, OrderKind::kResume);
}

TEST(ReplayModel, SpeedsAndNothingOfASession) {
    ReplayBench bench;
    for (std::size_t i = 0; i < kReplaySpeeds.size(); ++i) {
        const auto command = static_cast<Command>(static_cast<std::size_t>(Command::kSpeed0) + i);
        const Order order = bench.first(command);
        EXPECT_EQ(order.kind, OrderKind::kSpeed);
        EXPECT_EQ(order.value, kReplaySpeeds[i]);
        EXPECT_EQ(bench.model.replay().speed(), kReplaySpeeds[i]);
    }
    EXPECT_EQ(bench.press(Command::kStart), std::nullopt);
    EXPECT_EQ(bench.press(Command::kVF), std::nullopt);
    EXPECT_TRUE(bench.model.replaying());
    bench.session.replay.reset();  // a session has taken its place
    bench.pass(1100);
    EXPECT_FALSE(bench.model.replaying());
    EXPECT_EQ(bench.first(Command::kVF).kind, OrderKind::kStart);
}

TEST(ScrubScale, TimesAndPixelsAreEachOthersInverse) {
    const ScrubScale scrub{{100, 20, 200, 28}, 8};
    EXPECT_EQ(scrub.x(0), 100);
    EXPECT_EQ(scrub.x(8), 300);
    EXPECT_EQ(scrub.time_s(150), 2);
    for (double x = 100; x <= 300; x += 12.5) EXPECT_NEAR(scrub.x(scrub.time_s(x)), x, 1e-9);
    EXPECT_EQ(scrub.time_s(-50), 0);  // dragged beyond either end
    EXPECT_EQ(scrub.time_s(5000), 8);
    EXPECT_EQ(scrub.x(99), 300);
    EXPECT_EQ((ScrubScale{{100, 20, 0, 28}, 0}).time_s(100), 0);
    EXPECT_EQ((ScrubScale{{100, 20, 50, 28}, 0}).x(1), 100);
}

}  // namespace
}  // namespace thimble
