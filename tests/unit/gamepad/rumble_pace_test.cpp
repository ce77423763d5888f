#include "visual_node/gamepad/rumble_pace.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

class RumblePaceTest : public testing::Test {
  protected:
    // The command for these forces 20 ms after the last one.
    std::optional<RumbleLevels> later(double index_N, double thumb_N = 0) {
        now += milliseconds{20};
        return pace.next(now, index_N, thumb_N);
    }

    RumblePace pace;
    SessionTime now = at(milliseconds{500});
};

TEST_F(RumblePaceTest, IndexFingerIsTheStrongMotorThumbTheWeakOne) {
    EXPECT_EQ(later(0), std::nullopt);  // off is what a motor is anyway
    const auto index = later(kFullRumble_N);
    ASSERT_TRUE(index);
    EXPECT_EQ(index->strong, 65535);
    EXPECT_EQ(index->weak, 0);
    const auto thumb = later(0, 100);
    ASSERT_TRUE(thumb);
    EXPECT_EQ(*thumb, (RumbleLevels{0, 65535}));
    EXPECT_EQ(later(0), (RumbleLevels{0, 0}));
    EXPECT_EQ(later(0), std::nullopt);
}

TEST_F(RumblePaceTest, MoreForceIsMoreAndTheLeastTurnsAMotor) {
    std::uint16_t last = 0;
    for (double force_N = 0.2; force_N < kFullRumble_N + 0.2; force_N += 0.2) {
        const auto levels = later(force_N);
        ASSERT_TRUE(levels) << force_N;
        EXPECT_GT(levels->strong, last) << force_N;
        EXPECT_GE(levels->strong, kWeakestRumble * 65535) << force_N;
        last = levels->strong;
    }
    EXPECT_EQ(last, 65535);
}

TEST_F(RumblePaceTest, NoiseAboutZeroStartsNothingAndStopsNothing) {
    for (const double force_N : {0.06, 0.09, 0.06, 0.09}) EXPECT_EQ(later(force_N), std::nullopt);
    ASSERT_TRUE(later(0.11));
    for (const double force_N : {0.06, 0.09, 0.06, 0.09}) {
        const auto levels = later(force_N);
        EXPECT_TRUE(!levels || levels->strong > 0) << force_N;
    }
    EXPECT_EQ(later(0.04), RumbleLevels{});
}

TEST_F(RumblePaceTest, AtMostFiftyPerSecondHoweverTheForceMoves) {
    int said = 0;
    for (int i = 0; i < 1000; ++i) {
        now += milliseconds{1};
        said += pace.next(now, i % 2 == 0 ? 0.0 : 4.0, i % 3).has_value();
    }
    EXPECT_LE(said, 50);
    EXPECT_GE(said, 40);
}

TEST_F(RumblePaceTest, WhatHoldsIsSaidAgainBeforeItStopsByItself) {
    int said = 0;
    for (int i = 0; i < 2000; ++i) {
        now += milliseconds{1};
        said += pace.next(now, 2, 0).has_value();
    }
    EXPECT_EQ(said, 8);  // 2 s / 250 ms
}

TEST_F(RumblePaceTest, NoForceIsNone) {
    ASSERT_TRUE(later(2, 2));
    const double nan = std::nan("");
    EXPECT_EQ(later(nan, -5), RumbleLevels{});
    EXPECT_EQ(later(std::numeric_limits<double>::infinity(), 0), (RumbleLevels{65535, 0}));
}

TEST_F(RumblePaceTest, AnotherDeviceIsToldAtOnce) {
    ASSERT_TRUE(later(2));
    pace.forget();
    EXPECT_TRUE(pace.next(now, 2, 0));
}

}  // namespace
}  // namespace thimble
