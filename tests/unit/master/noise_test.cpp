// Second-order statistics of the noise, over long runs and over many starts. Bounds are about five standard
// errors.
#include "master/operator/noise.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace thimble::test {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

StreamKey key(std::uint32_t trial, Purpose purpose = Purpose::kPositionNoise) {
    return {.study = 3, .experiment = 1, .subject = 2, .trial = trial, .purpose = purpose};
}

template <typename Noise>
std::vector<double> run(Noise noise, std::size_t ticks) {
    std::vector<double> values(ticks);
    for (double& value : values) value = noise.next();
    return values;
}

double correlation(const std::vector<double>& values, std::size_t lag) {
    double sum = 0;
    for (std::size_t i = lag; i < values.size(); ++i) sum += values[i] * values[i - lag];
    return sum / static_cast<double>(values.size() - lag);
}

// Exact whatever the tick.
TEST(OrnsteinUhlenbeck, HasUnitVarianceAndItsCorrelationTime) {
    for (const std::size_t tick_ms : {1, 25}) {
        const auto values =
            run(OrnsteinUhlenbeck(key(1), 0.05, static_cast<int>(tick_ms) * kTick), 2'000'000 / tick_ms);
        EXPECT_NEAR(correlation(values, 0), 1, 0.04);
        EXPECT_NEAR(correlation(values, 50 / tick_ms), std::exp(-1.0), 0.04);
        EXPECT_NEAR(correlation(values, 400 / tick_ms), 0, 0.04);
    }
}

// Over many starts: at once, and a quarter period of the tremor later.
template <typename Make>
void expect_stationary(const Make& make) {
    double now = 0, later = 0;
    constexpr std::uint32_t kRuns = 20000;
    for (std::uint32_t trial = 1; trial <= kRuns; ++trial) {
        auto noise = make(key(trial));
        double value = noise.next();
        now += value * value;
        for (int i = 0; i < 28; ++i) value = noise.next();
        later += value * value;
    }
    EXPECT_NEAR(now / kRuns, 1, 0.05);
    EXPECT_NEAR(later / kRuns, 1, 0.05);
}

TEST(Noise, StartsInItsStationaryDistribution) {
    expect_stationary([](const StreamKey& each) { return OrnsteinUhlenbeck(each, 1.0, kTick); });
    expect_stationary([](const StreamKey& each) { return Tremor(each, 9, 0.15, kTick); });
}

TEST(Tremor, HasUnitVarianceAndRingsAtItsFrequency) {
    const double zeta = 0.15, frequency_Hz = 9;
    const auto values = run(Tremor(key(1), frequency_Hz, zeta, kTick), 1'000'000);
    EXPECT_NEAR(correlation(values, 0), 1, 0.04);
    // Autocorrelation of a damped oscillator in white noise: e^-zwt (cos w_d t + z / sqrt(1 - z^2) sin w_d
    // t).
    for (const std::size_t lag : {10U, 28U, 56U, 112U}) {
        const double w = 2 * std::numbers::pi * frequency_Hz, t = 1e-3 * static_cast<double>(lag);
        const double root = std::sqrt(1 - zeta * zeta);
        const double expected =
            std::exp(-zeta * w * t) * (std::cos(w * root * t) + zeta / root * std::sin(w * root * t));
        EXPECT_NEAR(correlation(values, lag), expected, 0.04) << lag;
    }
}

TEST(Noise, IsItsKey) {
    const auto first = run(OrnsteinUhlenbeck(key(1), 0.1, kTick), 100);
    EXPECT_EQ(first, run(OrnsteinUhlenbeck(key(1), 0.1, kTick), 100));
    EXPECT_NE(first, run(OrnsteinUhlenbeck(key(2), 0.1, kTick), 100));
    EXPECT_NE(first, run(OrnsteinUhlenbeck(key(1, Purpose::kForceNoise), 0.1, kTick), 100));
    EXPECT_EQ(run(Tremor(key(1), 9, 0.15, kTick), 100), run(Tremor(key(1), 9, 0.15, kTick), 100));
}

}  // namespace
}  // namespace thimble::test
