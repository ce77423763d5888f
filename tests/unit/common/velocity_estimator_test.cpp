// What every velocity estimator promises: the velocity is the slope of the smooth position, whatever the
// samples; a straight line is found exactly; samples that cannot be used change nothing.
#include "common/velocity_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr double kQuantum_m = 3e-5;

VelocitySettings velocity_of(VelocityMethod method, FoawFit fit = FoawFit::kBest) {
    VelocitySettings settings;
    settings.method = method;
    settings.fit = fit;
    settings.quantum_m = kQuantum_m;
    return settings;
}

std::vector<VelocitySettings> every_velocity_setting() {
    return {velocity_of(VelocityMethod::kLowPass),
            velocity_of(VelocityMethod::kRaw),
            velocity_of(VelocityMethod::kWindowed),
            velocity_of(VelocityMethod::kFoaw, FoawFit::kBest),
            velocity_of(VelocityMethod::kFoaw, FoawFit::kEnd),
            velocity_of(VelocityMethod::kKalman)};
}

std::string name_of(const VelocitySettings& settings) {
    std::string name{kVelocityMethodNames[static_cast<std::size_t>(settings.method)]};
    if (settings.method == VelocityMethod::kFoaw) name += settings.fit == FoawFit::kEnd ? "_end" : "_best";
    return name;
}

double quantised_m(double position_m) { return std::round(position_m / kQuantum_m) * kQuantum_m; }

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

// Each method against what its header says: response to one quantum, filter equations, brute force.
constexpr Duration kStep = milliseconds{1};

// Velocities after one quantum has come and stays, at 1 kHz.
std::vector<double> quantum_response(const VelocitySettings& settings, int steps) {
    VelocityEstimator estimator(settings);
    estimator.reset(0);
    SessionTime now{};
    std::vector<double> velocities;
    for (int i = 0; i <= 300; ++i, now += kStep) estimator.update(now, 0);
    for (int i = 0; i < steps; ++i, now += kStep) {
        velocities.push_back(estimator.update(now, kQuantum_m).velocity_m_per_s);
    }
    return velocities;
}

TEST(LowPassVelocity, AQuantumFadesWithTau) {
    const auto response = quantum_response(velocity_of(VelocityMethod::kLowPass), 20);
    EXPECT_NEAR(response[0], kQuantum_m / 0.006, 1e-12);
    for (int i = 1; i < 20; ++i) EXPECT_NEAR(response[i], response[i - 1] * 5 / 6, 1e-12);
}

TEST(RawVelocity, AQuantumIsOneSpike) {
    const auto response = quantum_response(velocity_of(VelocityMethod::kRaw), 3);
    EXPECT_NEAR(response[0], 0.030, 1e-12);
    EXPECT_EQ(response[1], 0);
}

TEST(WindowedVelocity, IsTheDifferenceOverTheWindowAtEvenSampling) {
    VelocityEstimator estimator(velocity_of(VelocityMethod::kWindowed));
    std::vector<double> samples;
    for (int i = 0; i < 500; ++i) {
        samples.push_back(quantised_m(0.05 * std::sin(0.013 * i)));
        const auto estimate = estimator.update(SessionTime{i * kStep}, samples.back());
        if (i < 20) continue;
        EXPECT_NEAR(estimate.velocity_m_per_s, (samples[i] - samples[i - 20]) / 0.020, 1e-12);
    }
}

// 2000 samples in a window that holds 256: coarser than asked for, but still a mean and its slope.
TEST(WindowedVelocity, MoreSamplesThanFitDoNoHarm) {
    VelocityEstimator estimator(velocity_of(VelocityMethod::kWindowed));
    VelocityEstimator::Estimate estimate;
    for (int i = 0; i <= 20000; ++i) {
        estimate = estimator.update(SessionTime{microseconds{10 * i}}, 1e-7 * i);
    }
    EXPECT_NEAR(estimate.velocity_m_per_s, 0.01, 1e-9);
    EXPECT_LT(estimate.position_estimate_m, 2e-3);
    EXPECT_GT(estimate.position_estimate_m, 2e-3 - 0.01 * 0.020);
}

struct TimedSample {
    double time_s, position_m;
};

double line_slope(const std::vector<TimedSample>& s, std::size_t points, FoawFit fit) {
    const std::size_t last = s.size() - 1, first = last - points;
    if (fit == FoawFit::kEnd) {
        return (s[last].position_m - s[first].position_m) / (s[last].time_s - s[first].time_s);
    }
    double mean_t = 0, mean_x = 0, above = 0, below = 0;
    const auto n = static_cast<double>(points + 1);
    for (std::size_t i = first; i <= last; ++i) mean_t += s[i].time_s / n, mean_x += s[i].position_m / n;
    for (std::size_t i = first; i <= last; ++i) {
        above += (s[i].time_s - mean_t) * (s[i].position_m - mean_x);
        below += (s[i].time_s - mean_t) * (s[i].time_s - mean_t);
    }
    return above / below;
}

// The paper's algorithm word by word, every point of every window looked at anew.
double brute_force_slope(const std::vector<TimedSample>& s, FoawFit fit, double window_s, double band_m) {
    const TimedSample newest = s.back();
    double slope = 0;
    for (std::size_t n = 1; n < s.size(); ++n) {
        if (n > 1 && newest.time_s - s[s.size() - 1 - n].time_s > window_s + 1e-9) break;
        const double trial = line_slope(s, n, fit);
        for (std::size_t i = 1; i <= n; ++i) {
            const TimedSample& point = s[s.size() - 1 - i];
            const double on_line_m = newest.position_m - trial * (newest.time_s - point.time_s);
            if (std::fabs(point.position_m - on_line_m) > band_m * (1 + 1e-6)) return slope;
        }
        slope = trial;
    }
    return slope;
}

class Foaw : public testing::TestWithParam<FoawFit> {};

TEST_P(Foaw, FindsTheSlopesThatBruteForceFinds) {
    EXPECT_TRUE(rc::check("brute force", [] {
        // Not quantised: no point lies on the edge of the band, where rounding would decide.
        FoawVelocity foaw(GetParam(), milliseconds{20}, kQuantum_m);
        const double start_m = *rc::gen::inRange(-1000, 1000) * 1e-4;
        foaw.reset(start_m);
        std::vector<TimedSample> samples{{0, start_m}};
        double velocity_m_per_s = 0;
        for (int i = 0; i < 80; ++i) {
            const Duration step = microseconds{*rc::gen::inRange(300, 3000)};
            velocity_m_per_s += *rc::gen::inRange(-1000, 1000) * 3e-6;
            const double noise_m = *rc::gen::inRange(-1000, 1000) * 1.7e-8;
            const double time_s = samples.back().time_s + to_seconds(step);
            samples.push_back({time_s, start_m + velocity_m_per_s * time_s + noise_m});
            foaw.advance(step, samples.back().position_m);
            const double expected = brute_force_slope(samples, GetParam(), 0.020, kQuantum_m);
            RC_ASSERT(std::fabs(foaw.slope_m_per_s() - expected) <= 1e-9);
        }
    }));
}

TEST_P(Foaw, TheNewestTwoSamplesCountHoweverFarApart) {
    FoawVelocity foaw(GetParam(), milliseconds{20}, kQuantum_m);
    foaw.reset(0);
    foaw.advance(milliseconds{50}, 0.001);
    EXPECT_NEAR(foaw.slope_m_per_s(), 0.02, 1e-12);
}

TEST_P(Foaw, UsesTheWholeWindowOnAQuantisedLine) {
    FoawVelocity foaw(GetParam(), milliseconds{20}, kQuantum_m);
    foaw.reset(0);
    for (int ms = 1; ms < 1000; ++ms) {
        foaw.advance(kStep, quantised_m(0.0123e-3 * ms));
        if (ms <= 20) continue;
        ASSERT_NEAR(foaw.slope_m_per_s(), 0.0123, kQuantum_m / 0.020) << ms;
    }
}

TEST_P(Foaw, TheSmoothPositionIsPulledAsDocumented) {
    FoawVelocity foaw(GetParam(), milliseconds{20}, kQuantum_m);
    foaw.reset(0);
    double before_m = 0;
    for (int ms = 1; ms < 300; ++ms) {
        const double sample_m = quantised_m(0.02 * std::sin(0.02 * ms));
        const double smooth_m = foaw.advance(kStep, sample_m);
        const double carried_m = before_m + foaw.slope_m_per_s() * 1e-3;
        EXPECT_NEAR((smooth_m - before_m) / 1e-3, foaw.slope_m_per_s() + (sample_m - carried_m) / 0.101,
                    1e-12);
        before_m = smooth_m;
    }
}

INSTANTIATE_TEST_SUITE_P(Fit, Foaw, testing::Values(FoawFit::kBest, FoawFit::kEnd),
                         [](const auto& test) { return test.param == FoawFit::kBest ? "best" : "end"; });

TEST(KalmanVelocity, TheSlopeIsTheVelocityStateAtEvenSampling) {
    KalmanVelocity kalman(1e-4, kQuantum_m, kStep);
    kalman.reset(0);
    double before_m = 0;
    for (int ms = 1; ms < 2000; ++ms) {
        const double smooth_m = kalman.advance(kStep, quantised_m(0.05 * std::sin(0.01 * ms)));
        ASSERT_NEAR((smooth_m - before_m) / 1e-3, kalman.velocity_state_m_per_s(), 1e-9) << ms;
        before_m = smooth_m;
    }
}

// Steps of 0.85 to 1.3 ms, velocities up to 500 mm/s, once the start from rest is over.
TEST(KalmanVelocity, AndNearlySoAtUnevenSampling) {
    KalmanVelocity kalman(1e-4, kQuantum_m, kStep);
    kalman.reset(0);
    double before_m = 0, time_s = 0;
    for (int i = 1; i < 4000; ++i) {
        const Duration step = microseconds{i % 3 == 0 ? 1300 : 850};
        time_s += to_seconds(step);
        const double smooth_m = kalman.advance(step, quantised_m(0.05 * std::sin(10 * time_s)));
        const double slope_m_per_s = (smooth_m - before_m) / to_seconds(step);
        before_m = smooth_m;
        if (i < 100) continue;
        ASSERT_NEAR(slope_m_per_s, kalman.velocity_state_m_per_s(), 3e-3) << i;
    }
}

TEST(KalmanVelocity, TheCovarianceStaysWhereItIs) {
    KalmanVelocity kalman(1e-4, kQuantum_m, kStep);
    kalman.reset(0);
    const double start = kalman.velocity_variance_m2_per_s2();
    ASSERT_GT(start, 0);
    for (int i = 0; i < 1'000'000; ++i) kalman.advance(kStep, 0);
    EXPECT_NEAR(kalman.velocity_variance_m2_per_s2(), start, 1e-9 * start);
    // A gap leaves it in doubt; a second of samples settles it again.
    kalman.advance(milliseconds{500}, 0);
    EXPECT_GT(kalman.velocity_variance_m2_per_s2(), 1.5 * start);
    for (int i = 0; i < 1000; ++i) kalman.advance(kStep, 0);
    EXPECT_NEAR(kalman.velocity_variance_m2_per_s2(), start, 1e-9 * start);
}

TEST(KalmanVelocity, TheLagFollowsTheContinuousFilter) {
    for (const double noise : {1e-7, 1e-6, 1e-5}) {
        const double rate_per_s = std::sqrt(std::sqrt(noise / (kQuantum_m * kQuantum_m / 12 * 1e-3)));
        const double lag_s = KalmanVelocity(noise, kQuantum_m, kStep).lag_s();
        EXPECT_NEAR(lag_s, std::sqrt(2.0) / rate_per_s, 0.001) << noise;
    }
}

}  // namespace
}  // namespace thimble::test
