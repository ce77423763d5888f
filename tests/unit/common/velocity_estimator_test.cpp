// What every velocity estimator promises: the velocity is the slope of the smooth position, whatever the
// samples; a straight line is found exactly; samples that cannot be used change nothing.
#include "common/velocity_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/common/velocity_cases.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr double kTissueDamping_Ns_per_m = 5;
constexpr double kPunctureForce_N = 0.1;

SessionTime at_ms(int ms) { return SessionTime{milliseconds{ms}}; }

class AnyVelocityEstimator : public testing::TestWithParam<VelocitySettings> {};

TEST_P(AnyVelocityEstimator, TheSlopeOfTheSmoothPositionIsTheVelocityAtAnySampling) {
    EXPECT_TRUE(rc::check("slope", [] {
        VelocityEstimator estimator(GetParam());
        SessionTime now{};
        double before_m = estimator.update(now, 0).position_estimate_m;
        for (int i = 0; i < 60; ++i) {
            const Duration dt = microseconds{*rc::gen::inRange(1, 20000)};
            now += dt;
            const double position_m = *rc::gen::inRange(-5000, 5000) * kQuantum_m;
            const auto estimate = estimator.update(now, position_m);
            const double slope = (estimate.position_estimate_m - before_m) / to_seconds(dt);
            RC_ASSERT(std::fabs(slope - estimate.velocity_m_per_s) <= 1e-12 * std::fabs(slope));
            before_m = estimate.position_estimate_m;
        }
    }));
}

// From any past, a second of straight line is enough (the slow pull of foaw takes longest).
TEST_P(AnyVelocityEstimator, FindsTheVelocityOfALineAtUnevenSampling) {
    EXPECT_TRUE(rc::check("line", [] {
        VelocityEstimator estimator(GetParam());
        SessionTime now{};
        estimator.update(now, 0.01);
        const double velocity_m_per_s = *rc::gen::inRange(-2000, 2000) * 1e-4;
        double found_m_per_s = 0;
        for (int i = 0; i < 3000; ++i) {
            now += microseconds{i % 7 == 0 ? 1700 : 900};
            found_m_per_s =
                estimator.update(now, velocity_m_per_s * to_seconds(now.time_since_epoch())).velocity_m_per_s;
        }
        RC_ASSERT(std::fabs(found_m_per_s - velocity_m_per_s) <= 1e-9);
    }));
}

TEST_P(AnyVelocityEstimator, GivesFiniteNumbersForFiniteSamples) {
    EXPECT_TRUE(rc::check("finite", [] {
        VelocityEstimator estimator(GetParam());
        SessionTime now{};
        for (int i = 0; i < 50; ++i) {
            const int exponent = *rc::gen::inRange(0, 19);
            now += Duration{static_cast<std::int64_t>(std::pow(10.0, exponent))} / 100;
            const double position_m = *rc::gen::inRange(-1000, 1000) * 0.01;
            const auto estimate = estimator.update(now, position_m);
            RC_ASSERT(std::isfinite(estimate.velocity_m_per_s));
            RC_ASSERT(std::isfinite(estimate.position_estimate_m));
        }
    }));
}

TEST_P(AnyVelocityEstimator, SamplesThatCannotBeUsedChangeNothing) {
    VelocityEstimator disturbed(GetParam()), calm(GetParam());
    for (int ms = 0; ms < 100; ++ms) {
        const double position_m = quantised_m(3e-6 * ms * ms);
        const auto estimate = disturbed.update(at_ms(ms), position_m);
        const auto expected = calm.update(at_ms(ms), position_m);
        ASSERT_EQ(estimate.velocity_m_per_s, expected.velocity_m_per_s) << ms;
        ASSERT_EQ(estimate.position_estimate_m, expected.position_estimate_m) << ms;
        for (const auto again : {disturbed.update(at_ms(ms), 0.5), disturbed.update(at_ms(ms - 3), 0.5),
                                 disturbed.update(at_ms(ms + 1), std::numeric_limits<double>::quiet_NaN()),
                                 disturbed.update(at_ms(ms + 1), std::numeric_limits<double>::infinity())}) {
            ASSERT_EQ(again.velocity_m_per_s, estimate.velocity_m_per_s) << ms;
            ASSERT_EQ(again.position_estimate_m, estimate.position_estimate_m) << ms;
        }
    }
    EXPECT_GT(calm.update(at_ms(100), 0.03).velocity_m_per_s, 0.1);
}

TEST_P(AnyVelocityEstimator, ResetIsRestAtAPlace) {
    VelocityEstimator used(GetParam()), fresh(GetParam());
    for (int ms = 0; ms < 50; ++ms) used.update(at_ms(ms), 1e-3 * ms);
    used.reset(0.25);
    fresh.reset(0.25);
    const auto estimate = used.update(at_ms(900), 0.7);  // only starts the clock
    EXPECT_EQ(estimate.velocity_m_per_s, 0);
    EXPECT_EQ(estimate.position_estimate_m, 0.25);
    fresh.update(at_ms(900), 0.7);
    for (int ms = 901; ms < 950; ++ms) {
        const double position_m = 0.25 + 1e-4 * (ms - 900);
        ASSERT_EQ(used.update(at_ms(ms), position_m).velocity_m_per_s,
                  fresh.update(at_ms(ms), position_m).velocity_m_per_s);
    }
}

TEST_P(AnyVelocityEstimator, IsAtRestWhereTheSamplesAre) {
    VelocityEstimator estimator(GetParam());
    estimator.reset(0.123);
    for (int ms = 0; ms < 3000; ++ms) {
        const auto estimate = estimator.update(at_ms(ms), 0.123);
        ASSERT_NEAR(estimate.velocity_m_per_s, 0, 1e-12) << ms;
        ASSERT_NEAR(estimate.position_estimate_m, 0.123, 1e-15) << ms;
    }
}

// The lag on a line that each header states.
TEST_P(AnyVelocityEstimator, TheSmoothPositionLagsALineAsDocumented) {
    double lag_s = 0;  // raw and foaw
    if (GetParam().method == VelocityMethod::kLowPass) lag_s = 0.005;
    if (GetParam().method == VelocityMethod::kWindowed) lag_s = (0.020 - 0.001) / 2;
    if (GetParam().method == VelocityMethod::kKalman) {
        lag_s = KalmanVelocity(GetParam().acceleration_noise_m2_per_s3, kQuantum_m, milliseconds{1}).lag_s();
        ASSERT_GT(lag_s, 0.001);
    }
    VelocityEstimator estimator(GetParam());
    VelocityEstimator::Estimate estimate;
    constexpr double kVelocity_m_per_s = 0.02;
    for (int ms = 0; ms <= 4000; ++ms) estimate = estimator.update(at_ms(ms), kVelocity_m_per_s * 1e-3 * ms);
    EXPECT_NEAR(estimate.position_estimate_m, kVelocity_m_per_s * (4 - lag_s), 1e-11);
    EXPECT_NEAR(estimate.velocity_m_per_s, kVelocity_m_per_s, 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Each, AnyVelocityEstimator, testing::ValuesIn(every_velocity_setting()),
                         [](const auto& test) { return name_of(test.param); });

// Largest viscous force that a needle pressed at 10 mm/s seems to meet.
double largest_viscous_force_N(const VelocitySettings& settings) {
    VelocityEstimator estimator(settings);
    double largest_N = 0;
    for (int ms = 0; ms < 2000; ++ms) {
        const auto estimate = estimator.update(at_ms(ms), quantised_m(ms * 1e-5));
        largest_N = std::max(largest_N, kTissueDamping_Ns_per_m * estimate.velocity_m_per_s);
    }
    return largest_N;
}

TEST(VelocityEstimator, OneEncoderCountDoesNotPuncture) {
    for (const VelocitySettings& settings : every_velocity_setting()) {
        if (settings.method == VelocityMethod::kRaw) continue;
        EXPECT_LT(largest_viscous_force_N(settings), kPunctureForce_N) << name_of(settings);
        EXPECT_GT(largest_viscous_force_N(settings), 0.999 * kTissueDamping_Ns_per_m * 0.010)
            << name_of(settings);
    }
}

TEST(VelocityEstimator, TheRawDifferenceWould) {
    EXPECT_NEAR(largest_viscous_force_N(velocity_of(VelocityMethod::kRaw)), 0.15, 1e-9);
}

// Averages of what was seen; foaw and kalman extrapolate.
TEST(VelocityEstimator, AveragesNeverLeaveTheRangeOfTheirInput) {
    EXPECT_TRUE(rc::check("range", [] {
        VelocitySettings settings = velocity_of(
            *rc::gen::element(VelocityMethod::kLowPass, VelocityMethod::kWindowed, VelocityMethod::kRaw));
        settings.time_constant = milliseconds{*rc::gen::inRange(0, 50)};
        settings.window = milliseconds{*rc::gen::inRange(1, 50)};
        VelocityEstimator estimator(settings);
        SessionTime now{};
        double low = 1, high = -1;
        for (int i = 0; i < 60; ++i) {
            now += microseconds{*rc::gen::inRange(1, 5000)};
            const double position_m = *rc::gen::inRange(-100, 100) * kQuantum_m;
            low = std::min(low, position_m), high = std::max(high, position_m);
            const double smooth_m = estimator.update(now, position_m).position_estimate_m;
            RC_ASSERT(smooth_m >= low - 1e-15 && smooth_m <= high + 1e-15);
        }
    }));
}

}  // namespace
}  // namespace thimble::test
