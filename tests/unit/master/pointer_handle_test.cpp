// A handle drawn by a pointer: where it comes to rest, how it lets go, what it refuses.
#include "master/devices/pointer_handle.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/allocation_count.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

HandleSettings without_friction() { return {.mechanics = {.friction_N = 0}}; }

class PointerHandleTest : public testing::Test {
  protected:
    explicit PointerHandleTest(const HandleSettings& settings = without_friction()) : handle(settings) {
        handle.start_trial(now, {});
    }
    // The pointer stays there for so long, said each 10 ms.
    void draw_to(double wanted_m, Duration time, bool engaged = true) {
        for (const SessionTime end = now + time; now < end; now += milliseconds{10}) {
            handle.follow(now, {wanted_m, engaged});
            handle.read(now);
        }
        handle.read(now);
    }
    SessionTime now = at(seconds{5});
    PointerHandle handle;
};

TEST_F(PointerHandleTest, IsDrawnToWhereThePointerIs) {
    EXPECT_EQ(handle.read(now).position_hand_m, 0);
    draw_to(0.02, seconds{2});
    EXPECT_NEAR(handle.position_hand_m(), 0.02, 1e-7);
    EXPECT_DOUBLE_EQ(handle.read(now).position_hand_m, 0.02);
    EXPECT_FALSE(handle.finished());
}

TEST_F(PointerHandleTest, AForceShiftsItByTheCouplingsSpring) {
    draw_to(0.02, seconds{1});
    handle.command_force(now, 2);
    draw_to(0.02, seconds{2});
    EXPECT_NEAR(handle.position_hand_m(), 0.02 - 2.0 / 500, 1e-6);
    EXPECT_EQ(handle.read(now).force_hand_N, 2);
}

TEST_F(PointerHandleTest, IsPulledByNoMoreThanTheCouplingsLimit) {
    handle.follow(now, {1, true});  // across the screen: 500 N without the limit
    handle.read(now += milliseconds{1});
    EXPECT_NEAR(handle.velocity_hand_m_per_s(), 6 / 0.25 * 0.001, 0.003);
    handle.command_force(now, 6);
    draw_to(1, seconds{1});
    EXPECT_NEAR(handle.velocity_hand_m_per_s(), 0, 1e-9);
}

TEST_F(PointerHandleTest, LetGoItIsBrakedAndNotDrawnBack) {
    draw_to(0.1, milliseconds{100});
    ASSERT_GT(handle.velocity_hand_m_per_s(), 0.1);
    const double here_m = handle.position_hand_m(), speed_m_per_s = handle.velocity_hand_m_per_s();
    draw_to(-0.5, seconds{1}, false);
    EXPECT_NEAR(handle.velocity_hand_m_per_s(), 0, 1e-9);
    EXPECT_NEAR(handle.position_hand_m(), here_m + speed_m_per_s * 0.25 / (15 + 1), 1e-4);  // v m / b
}

// The tenth of a second is exact: from then on it moves as one that was told to let go.
TEST_F(PointerHandleTest, WithoutInputForATenthOfASecondItIsLetGo) {
    PointerHandle told(without_friction());
    told.start_trial(now, {});
    for (PointerHandle* each : {&handle, &told}) {
        each->follow(now, {0.02, true});
        each->read(now + milliseconds{100});
    }
    EXPECT_GT(handle.position_hand_m(), 0.001);
    told.follow(now + milliseconds{100}, {0.02, false});
    for (const Duration later : {Duration{milliseconds{150}}, Duration{seconds{3}}}) {
        EXPECT_EQ(handle.read(now + later).position_hand_m, told.read(now + later).position_hand_m);
    }
    const double rest_m = handle.position_hand_m();
    EXPECT_GT(std::fabs(rest_m - 0.02), 1e-4);  // it was not drawn to the end
    handle.read(now + seconds{4});
    EXPECT_NEAR(handle.position_hand_m(), rest_m, 1e-9);
}

TEST_F(PointerHandleTest, OnceLetGoAPushMovesItOutAndNothingDrawsItIn) {
    draw_to(0.02, seconds{1});
    draw_to(0.02, milliseconds{200}, false);
    handle.command_force(now, 3);
    draw_to(0.02, milliseconds{300}, false);
    handle.command_force(now, 0);
    draw_to(0.02, seconds{1}, false);
    const double out_m = handle.position_hand_m();
    EXPECT_LT(out_m, 0.01);
    draw_to(0.02, seconds{1}, false);
    EXPECT_NEAR(handle.position_hand_m(), out_m, 1e-9);
}

TEST_F(PointerHandleTest, WhoCallsAndWhenDoesNotMatter) {
    PointerHandle other(without_friction());
    other.start_trial(now, {});
    handle.follow(now, {0.01, true});
    other.follow(now, {0.01, true});
    for (int us = 0; us < 90'000; us += 370) other.read(now + microseconds{us});
    EXPECT_EQ(handle.read(now + milliseconds{90}).position_hand_m,
              other.read(now + milliseconds{90}).position_hand_m);
    EXPECT_EQ(handle.position_hand_m(), other.position_hand_m());
}

TEST_F(PointerHandleTest, ATrialBeginsAtRestAtZero) {
    draw_to(0.05, seconds{1});
    handle.command_force(now, 4);
    handle.start_trial(now, {});
    EXPECT_EQ(handle.read(now).position_hand_m, 0);
    EXPECT_EQ(handle.read(now).force_hand_N, 0);
    EXPECT_EQ(handle.read(now + seconds{1}).position_hand_m, 0);  // released until the next input
}

TEST_F(PointerHandleTest, AllocatesNothing) {
    const auto before = allocation_count();
    draw_to(0.02, seconds{1});
    handle.command_force(now, 1);
    EXPECT_EQ(allocation_count(), before);
}

class RoughPointerHandleTest : public PointerHandleTest {
  protected:
    RoughPointerHandleTest() : PointerHandleTest(HandleSettings{}) {}
};

TEST_F(RoughPointerHandleTest, FrictionHoldsItWhereThePullIsTooWeak) {
    draw_to(0.001, seconds{2});  // 0.5 N against 0.65 N
    EXPECT_LT(handle.position_hand_m(), 0.0005);
    draw_to(0.02, seconds{2});
    EXPECT_NEAR(handle.position_hand_m(), 0.02, 0.65 / 500);
}

}  // namespace
}  // namespace thimble::test
