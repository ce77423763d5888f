// The Falcon's geometry against vectors that were computed independently, and against itself.
#include "master/devices/falcon/falcon_kinematics.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace thimble {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

struct Golden {
    DeviceVector position_m;
    FalconAngles degrees;
    std::array<double, 3> counts;
};

constexpr Golden kGolden[] = {
    {{0, 0, 0.100}, {8.0081, 8.0081, 8.0081}, {-740.8, -740.8, -740.8}},
    {{0, 0, 0.110}, {16.1880, 16.1880, 16.1880}, {-516.3, -516.3, -516.3}},
    {{0, 0, 0.125}, {27.7093, 27.7093, 27.7093}, {-200.1, -200.1, -200.1}},
    {{0, 0, 0.150}, {47.2433, 47.2433, 47.2433}, {336.0, 336.0, 336.0}},
    {{0.02, -0.01, 0.13}, {42.3745, 20.0613, 37.5249}, {202.4, -410.0, 69.3}},
    {{-0.03, 0.03, 0.125}, {11.0071, 54.7653, 37.4013}, {-658.5, 542.5, 65.9}},
};

TEST(FalconKinematics, GoldenPositionsHaveTheirAngles) {
    for (const Golden& golden : kGolden) {
        const auto angles_rad = falcon_leg_angles_rad(golden.position_m);
        ASSERT_TRUE(angles_rad);
        for (std::size_t leg = 0; leg < 3; ++leg) {
            EXPECT_NEAR((*angles_rad)[leg] / kDegree, golden.degrees[leg], 6e-5);
            const double counts = ((*angles_rad)[leg] - falcon_leg_angle_rad(0)) /
                                  (falcon_leg_angle_rad(1) - falcon_leg_angle_rad(0));
            EXPECT_NEAR(counts, golden.counts[leg], 0.06);
        }
        const auto back_m = falcon_position_m(*angles_rad);
        ASSERT_TRUE(back_m);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*back_m)[i], golden.position_m[i], 1e-10);
    }
}

TEST(FalconKinematics, GoldenCountsHaveTheirHeight) {
    const auto height_m = [](std::int16_t n) {
        const double theta_rad = falcon_leg_angle_rad(n);
        const auto position_m = falcon_position_m({theta_rad, theta_rad, theta_rad});
        return position_m ? (*position_m)[2] : std::numeric_limits<double>::quiet_NaN();
    };
    EXPECT_NEAR(height_m(0), 0.134602, 1e-6);
    EXPECT_NEAR(height_m(500), 0.156860, 1e-6);
    EXPECT_NEAR(height_m(-500), 0.110754, 1e-6);
    EXPECT_NEAR(height_m(1000), 0.173603, 1e-6);
    EXPECT_NEAR(height_m(-1000), 0.089611, 1e-6);
    EXPECT_NEAR(height_m(1700), 0.183193, 1e-6);  // as far as the legs reach
    EXPECT_TRUE(std::isnan(height_m(1800)));
    EXPECT_TRUE(std::isnan(height_m(32767)));
}

TEST(FalconKinematics, TheWorkspaceIsFoundAgainFromFarAway) {
    for (int i = -4; i <= 4; ++i) {
        for (int j = -4; j <= 4; ++j) {
            for (int k = 0; k <= 6; ++k) {
                const DeviceVector p{0.01 * i, 0.01 * j, 0.09 + 0.01 * k};
                const auto angles_rad = falcon_leg_angles_rad(p);
                if (!angles_rad) continue;
                const auto back_m = falcon_position_m(*angles_rad);
                ASSERT_TRUE(back_m) << p[0] << ' ' << p[1] << ' ' << p[2];
                for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR((*back_m)[a], p[a], 1e-9);
            }
        }
    }
}

TEST(FalconKinematics, ForcesBecomeTheGoldenTorques) {
    const auto inwards_Nm = falcon_leg_torques_Nm({0, 0, 0.110}, {0, 0, -1});
    ASSERT_TRUE(inwards_Nm);
    for (const double torque_Nm : *inwards_Nm) EXPECT_NEAR(torque_Nm, -0.02418, 5e-6);
    const auto sideways_Nm = falcon_leg_torques_Nm({0, 0, 0.125}, {1, 0, 0});
    ASSERT_TRUE(sideways_Nm);
    EXPECT_NEAR((*sideways_Nm)[0], 0.01789, 1e-5);
    EXPECT_NEAR((*sideways_Nm)[1], -0.06060, 1e-5);
    EXPECT_NEAR((*sideways_Nm)[2], 0.04271, 1e-5);
}

// The work of the forces is the work of the torques, in any small motion.
TEST(FalconKinematics, TorquesDoTheWorkOfTheForce) {
    const DeviceVector p{0.01, -0.02, 0.13}, force_N{1, 2, -3};
    const auto torques_Nm = falcon_leg_torques_Nm(p, force_N);
    ASSERT_TRUE(torques_Nm);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        DeviceVector before = p, after = p;
        before[axis] -= 1e-6;
        after[axis] += 1e-6;
        const auto from_rad = falcon_leg_angles_rad(before), to_rad = falcon_leg_angles_rad(after);
        double work_J = 0;
        for (std::size_t leg = 0; leg < 3; ++leg)
            work_J += (*torques_Nm)[leg] * ((*to_rad)[leg] - (*from_rad)[leg]);
        EXPECT_NEAR(work_J, force_N[axis] * 2e-6, 1e-12);
    }
}

TEST(FalconKinematics, MotorsAreScaledTogetherAndNeverBeyondTheirLimit) {
    EXPECT_EQ(falcon_motors({-0.02418, -0.02418, -0.02418}, 10000).counts, (FalconTriple{242, 242, 242}));
    EXPECT_EQ(falcon_motors({0.01789, -0.06060, 0.04271}, 10000).counts, (FalconTriple{-179, 606, -427}));
    EXPECT_FALSE(falcon_motors({0.1, 0.2, 0.3}, 10000).saturated);
    const FalconMotors much = falcon_motors({0.4, -1, 0}, 10000);
    EXPECT_TRUE(much.saturated);
    EXPECT_EQ(much.counts, (FalconTriple{-1638, 4095, 0}));
    EXPECT_EQ(falcon_motors({std::numeric_limits<double>::quiet_NaN(), 1, 1}, 10000).counts, FalconTriple{});
}

TEST(FalconKinematics, OutOfReachIsNothing) {
    EXPECT_FALSE(falcon_leg_angles_rad({0.2, 0, 0.1}));
    EXPECT_FALSE(falcon_leg_angles_rad({0, 0, 0.3}));
    EXPECT_FALSE(falcon_leg_torques_Nm({0, 0, 0.3}, {0, 0, 1}));
    EXPECT_FALSE(falcon_position_m({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
}

}  // namespace
}  // namespace thimble
