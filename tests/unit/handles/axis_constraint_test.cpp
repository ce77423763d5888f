// One axis out of three: signs, origin, limits, and the spring that holds the other two.
#include "master/devices/axis_constraint.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr AxisSettings kAwayFromUser{0, -1, 0.01};

TEST(AxisConstraint, ZIsTheAxisFromItsOriginWithItsSign) {
    AxisConstraint axis(kAwayFromUser, 12);
    axis.move_to(at(milliseconds{1}), {-0.02, 0.5, 0.7});
    EXPECT_DOUBLE_EQ(axis.position_hand_m(), 0.03);
    // Pushing the hand out is -z, and z is -x.
    EXPECT_EQ(axis.force_device_N(5), (DeviceVector{5, 0, 0}));
}

TEST(AxisConstraint, ClipsAndRefusesWhatIsNoNumber) {
    const AxisConstraint axis(kAwayFromUser, 8);
    EXPECT_EQ(axis.clipped_N(9), 8);
    EXPECT_EQ(axis.clipped_N(-9), -8);
    EXPECT_EQ(axis.clipped_N(std::numeric_limits<double>::quiet_NaN()), 0);
    EXPECT_EQ(axis.force_device_N(std::numeric_limits<double>::infinity())[0], 0);
}

// Along z, with a virtual line to hold the hand on.
AxisSettings held(double stiffness_N_per_m, double damping_Ns_per_m) {
    return {2, 1, 0, LateralHold::kVirtual, stiffness_N_per_m, damping_Ns_per_m};
}

TEST(AxisConstraint, TheSpringPullsTowardsTheLineOnly) {
    AxisConstraint axis(held(1000, 0), 12);
    axis.move_to(at(milliseconds{0}), {0.1, 0.2, 0});
    axis.hold_here();
    axis.move_to(at(milliseconds{1}), {0.101, 0.198, 0.03});
    const DeviceVector force_N = axis.force_device_N(2);
    EXPECT_NEAR(force_N[0], -1, 1e-9);
    EXPECT_NEAR(force_N[1], 2, 1e-9);
    EXPECT_EQ(force_N[2], -2);
    AxisConstraint limited(held(1000, 0), 12);
    limited.move_to(at(milliseconds{1}), {0.03, 0.04, 0});  // from the line through 0: 50 N without the limit
    EXPECT_NEAR(limited.force_device_N(0)[0], -0.6 * 4, 1e-9);
    EXPECT_NEAR(limited.force_device_N(0)[1], -0.8 * 4, 1e-9);
}

TEST(AxisConstraint, TheDamperOpposesLateralMotion) {
    AxisConstraint axis(held(0, 10), 12);
    for (int ms = 0; ms < 100; ++ms) axis.move_to(at(milliseconds{ms}), {1e-4 * ms, 0, 0});
    EXPECT_NEAR(axis.force_device_N(0)[0], -10 * 0.1, 1e-6);
    axis.move_to(at(milliseconds{500}), {0.5, 0, 0});  // a pause says nothing about now
    EXPECT_EQ(axis.force_device_N(0)[0], 0);
}

}  // namespace
}  // namespace thimble
