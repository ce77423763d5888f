#include "analysis/statistics/descriptive.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(Descriptive, AgreesWithNumpyAndScipy) {
    for (const auto& g : golden("columns")) {
        SCOPED_TRACE(g.at("name"));
        const NamedValues values = column("x", g.at("values"));
        const double offset = g.at("offset");
        const double rounding = 2e-16 * std::abs(offset);
        // Relative to the spread: a mean near zero has no digits of its own.
        const double spread = 1e-13 * g.at("sd").get<double>() + rounding;
        EXPECT_TRUE(close(sample_mean(values) - offset, g.at("mean"), 1e-13, spread));
        EXPECT_TRUE(close(sample_sd(values), g.at("sd"), 1e-13));
        for (const auto& [p, expected] : g.at("quantiles").items()) {
            EXPECT_TRUE(close(sample_quantile(values, std::stod(p)) - offset, expected, 1e-13, spread)) << p;
        }
        EXPECT_EQ(sample_median(values), sample_quantile(values, 0.5));
        const ConfidenceInterval interval = mean_interval(values);
        EXPECT_TRUE(close(interval.low - offset, g.at("mean_interval")[0], 1e-12, spread));
        EXPECT_TRUE(close(interval.high - offset, g.at("mean_interval")[1], 1e-12, spread));
    }
}

TEST(Descriptive, ByHand) {
    const NamedValues values{"x", {4, 1, 3, 2}};
    EXPECT_EQ(sample_mean(values), 2.5);
    EXPECT_EQ(sample_median(values), 2.5);
    EXPECT_EQ(sample_quantile(values, 0.25), 1.75);
    EXPECT_DOUBLE_EQ(sample_sd(values), std::sqrt(5.0 / 3));
    EXPECT_EQ(sample_sd({"x", {7, 7, 7}}), 0);
    EXPECT_EQ(sample_median({"x", {7}}), 7);
    // One degree of freedom is a Cauchy distribution: t = tan(0.95 pi / 2).
    const ConfidenceInterval two = mean_interval({"x", {-1, 1}});
    EXPECT_TRUE(close(two.high, 12.706204736174704, 1e-13));
    EXPECT_EQ(two.low, -two.high);
}

TEST(Descriptive, AnOffsetCostsNoDigits) {
    std::vector<double> values;
    for (int i = 0; i < 1000; ++i) values.push_back(1e9 + (i % 2 == 0 ? 0.5 : -0.5));
    EXPECT_EQ(sample_mean({"x", values}), 1e9);
    EXPECT_DOUBLE_EQ(sample_sd({"x", values}), std::sqrt(250.0 / 999));
}

TEST(Descriptive, Refuses) {
    expect_refused([] { sample_mean({"time", {}}); }, {"mean", "time", "0 values"});
    expect_refused([] { sample_sd({"time", {1}}); }, {"standard deviation", "time", "at least 2"});
    expect_refused([] { sample_median({"time", {1, kMissing}}); }, {"time", "row 2", "nan"});
    expect_refused([] { sample_mean({"time", {1, kInfinite}}); }, {"time", "row 2", "inf"});
    expect_refused([] { sample_mean({"time", {1e151}}); }, {"time", "row 1"});
    expect_refused([] { sample_quantile({"time", {1, 2}}, 1.5); }, {"1.5", "[0, 1]"});
    expect_refused([] { mean_interval({"time", {1, 2}}, 95); }, {"95", "(0, 1)"});
    expect_refused([] { mean_interval({"time", {1, 2}}, kMissing); }, {"(0, 1)"});
}

TEST(Wilson, AgreesWithStatsmodels) {
    for (const auto& g : golden("proportions")) {
        SCOPED_TRACE(g.dump());
        const auto interval = wilson_interval(g.at("successes"), g.at("trials"));
        EXPECT_TRUE(close(interval.low, g.at("interval")[0], 1e-11, 1e-16));
        EXPECT_TRUE(close(interval.high, g.at("interval")[1], 1e-11));
    }
}

TEST(Wilson, SolvesItsEquation) {
    // (p - x)^2 = z^2 p (1 - p) / n at both ends.
    constexpr double kZ = 1.9599639845400542;
    const auto interval = wilson_interval(3, 20);
    for (const double p : {interval.low, interval.high}) {
        EXPECT_TRUE(close((p - 0.15) * (p - 0.15), kZ * kZ * p * (1 - p) / 20, 1e-13));
    }
}

TEST(Wilson, Edges) {
    EXPECT_EQ(wilson_interval(0, 10).low, 0);
    EXPECT_EQ(wilson_interval(10, 10).high, 1);
    for (std::size_t n = 1; n < 500; ++n) {
        EXPECT_EQ(wilson_interval(0, n).low, 0) << n;
        EXPECT_EQ(wilson_interval(n, n).high, 1) << n;
    }
    EXPECT_GT(wilson_interval(0, 10).high, 0.2);
    EXPECT_LT(wilson_interval(10, 10).low, 0.8);
    EXPECT_LT(wilson_interval(5, 10, 0.99).low, wilson_interval(5, 10, 0.9).low);
}

TEST(Wilson, Refuses) {
    expect_refused([] { wilson_interval(0, 0); }, {"0 trials"});
    expect_refused([] { wilson_interval(3, 2); }, {"3 successes in 2"});
    expect_refused([] { wilson_interval(1, 2, 0); }, {"(0, 1)"});
}

}  // namespace
}  // namespace thimble
