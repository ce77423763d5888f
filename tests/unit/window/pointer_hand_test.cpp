#include "visual_node/window/pointer_hand.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(PointerHand, MovesOnlyWhileItHolds) {
    PointerHand hand(1e-4);
    hand.move(100);
    EXPECT_EQ(hand.hand().position_hand_m, 0);
    EXPECT_FALSE(hand.hand().engaged);
    hand.take_hold();
    hand.move(100);
    EXPECT_NEAR(hand.hand().position_hand_m, 0.01, 1e-15);
    EXPECT_TRUE(hand.hand().engaged);
    hand.let_go();
    hand.move(100);
    EXPECT_NEAR(hand.hand().position_hand_m, 0.01, 1e-15);
    EXPECT_FALSE(hand.hand().engaged);
}

TEST(PointerHand, ReachesNoFurtherThanAnArm) {
    PointerHand hand(1e-4);
    hand.take_hold();
    hand.move(1e9);
    EXPECT_EQ(hand.hand().position_hand_m, PointerHand::kReach_m);
    hand.move(-1e9);
    EXPECT_EQ(hand.hand().position_hand_m, -PointerHand::kReach_m);
    hand.move(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(hand.hand().position_hand_m, -PointerHand::kReach_m);
    hand.home();
    EXPECT_EQ(hand.hand().position_hand_m, 0);
}

TEST(PointerHand, StickMovesByTimeOutsideItsDeadBand) {
    PointerHand hand(1e-4);
    hand.take_hold();
    hand.push(0.1, std::chrono::milliseconds{100});
    EXPECT_EQ(hand.hand().position_hand_m, 0);
    hand.push(1, std::chrono::milliseconds{100});
    EXPECT_NEAR(hand.hand().position_hand_m, 0.005, 1e-12);
    hand.push(-0.5, std::chrono::milliseconds{100});
    EXPECT_NEAR(hand.hand().position_hand_m, 0.0025, 1e-12);
}

}  // namespace
}  // namespace thimble
