// A 5 mm/s jump per encoder count instead of 30: what the low-pass is for, and what it must not break.
#include "common/velocity_estimator.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr double kCountNeedle_m = 3e-5;
constexpr double kTissueDamping_Ns_per_m = 5;
constexpr double kPunctureForce_N = 0.1;

// Largest viscous force that a needle pressed at 10 mm/s seems to meet.
double largest_viscous_force_N(Duration time_constant) {
    VelocityEstimator estimator(time_constant);
    double largest_N = 0;
    for (int ms = 0; ms < 2000; ++ms) {
        const double position_m = std::floor(ms * 1e-5 / kCountNeedle_m + 0.5) * kCountNeedle_m;
        const auto estimate = estimator.update(SessionTime{milliseconds{ms}}, position_m);
        largest_N = std::max(largest_N, kTissueDamping_Ns_per_m * estimate.velocity_m_per_s);
    }
    return largest_N;
}

TEST(VelocityEstimator, OneEncoderCountDoesNotPuncture) {
    EXPECT_LT(largest_viscous_force_N(milliseconds{5}), kPunctureForce_N);
    EXPECT_GT(largest_viscous_force_N(milliseconds{5}), kTissueDamping_Ns_per_m * 0.010);
}

TEST(VelocityEstimator, TheRawDifferenceWould) {
    EXPECT_NEAR(largest_viscous_force_N(Duration::zero()), 0.15, 1e-9);
}

TEST(VelocityEstimator, FollowsARampWithALagOfTau) {
    VelocityEstimator estimator(milliseconds{5});
    VelocityEstimator::Estimate estimate;
    for (int ms = 0; ms <= 200; ++ms)
        estimate = estimator.update(SessionTime{milliseconds{ms}}, 0.02e-3 * ms);
    EXPECT_NEAR(estimate.velocity_m_per_s, 0.02, 1e-9);
    EXPECT_NEAR(estimate.position_estimate_m, 0.02 * 0.2 - 0.02 * 0.005, 1e-9);
}

TEST(VelocityEstimator, SlopeOfTheSmoothPositionIsTheVelocityAtAnySampling) {
    EXPECT_TRUE(rc::check("slope", [] {
        VelocityEstimator estimator;
        SessionTime now{};
        double before_m = estimator.update(now, 0).position_estimate_m;
        for (int i = 0; i < 20; ++i) {
            const Duration dt = microseconds{*rc::gen::inRange(1, 20000)};
            now += dt;
            const double position_m = *rc::gen::inRange(-5000, 5000) * kCountNeedle_m;
            const auto estimate = estimator.update(now, position_m);
            const double slope = (estimate.position_estimate_m - before_m) / to_seconds(dt);
            RC_ASSERT(std::fabs(slope - estimate.velocity_m_per_s) <= 1e-12 * std::fabs(slope));
            before_m = estimate.position_estimate_m;
        }
    }));
}

TEST(VelocityEstimator, NeverLeavesTheRangeOfItsInput) {
    EXPECT_TRUE(rc::check("range", [] {
        VelocityEstimator estimator(milliseconds{*rc::gen::inRange(0, 50)});
        SessionTime now{};
        double low = 1, high = -1;
        for (int i = 0; i < 30; ++i) {
            now += microseconds{*rc::gen::inRange(1, 5000)};
            const double position_m = *rc::gen::inRange(-100, 100) * kCountNeedle_m;
            low = std::min(low, position_m), high = std::max(high, position_m);
            const double smooth_m = estimator.update(now, position_m).position_estimate_m;
            RC_ASSERT(smooth_m >= low - 1e-15 && smooth_m <= high + 1e-15);
        }
    }));
}

TEST(VelocityEstimator, ASampleFromThePastChangesNothing) {
    VelocityEstimator estimator;
    estimator.update(SessionTime{milliseconds{1}}, 0);
    const auto estimate = estimator.update(SessionTime{milliseconds{2}}, 1e-3);
    for (const auto when : {milliseconds{2}, milliseconds{1}}) {
        const auto again = estimator.update(SessionTime{when}, 5e-3);
        EXPECT_EQ(again.velocity_m_per_s, estimate.velocity_m_per_s);
        EXPECT_EQ(again.position_estimate_m, estimate.position_estimate_m);
    }
    EXPECT_GT(estimate.velocity_m_per_s, 0);
}

TEST(VelocityEstimator, ResetIsRestAtAPlace) {
    VelocityEstimator estimator;
    estimator.update(SessionTime{milliseconds{1}}, 0);
    estimator.update(SessionTime{milliseconds{2}}, 1);
    estimator.reset(0.25);
    const auto estimate = estimator.update(SessionTime{milliseconds{900}}, 0.25);
    EXPECT_EQ(estimate.velocity_m_per_s, 0);
    EXPECT_EQ(estimate.position_estimate_m, 0.25);
}

}  // namespace
}  // namespace thimble::test
