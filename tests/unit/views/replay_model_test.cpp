#include <gtest/gtest.h>

#include "tests/unit/views/played_session.hpp"
#include "visual_node/views/player_model.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A recorded trial of 10 s that stands still at 4 s, and obeys if it is asked to.
class ReplayBench {
  public:
    ReplayBench() {
        session.monitor.state = NodeState::kRunning;
        session.monitor.time_s = 4;
        session.monitor.paused = true;
        session.replay = ReplayState{};
        session.replay->duration_s = 10;
        pass(8);
    }
    void pass(int milliseconds_passed) {
        for (int i = 0; i < milliseconds_passed; i += 4) {
            now += milliseconds{4};
            session.say(now);
            model.update(now);
        }
    }
    std::vector<HeardOrder> press(Command command) {
        (void)session.heard(now);
        model.press(now, command);
        return session.heard(now);
    }
    // The first order of one press.
    Order first(Command command) {
        const auto heard = press(command);
        return heard.empty() ? Order{} : heard.front().order;
    }

    PlayedViewSession session;
    PlayerModel model{9, session.channels()};
    SessionTime now = at(milliseconds{100});
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
    (void)bench.session.heard(bench.now);
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
    const auto heard = bench.press(Command::kFrameOn);
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
    const auto heard = bench.press(Command::kPlayPause);
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
    EXPECT_TRUE(bench.press(Command::kStart).empty());
    EXPECT_TRUE(bench.press(Command::kVF).empty());
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
