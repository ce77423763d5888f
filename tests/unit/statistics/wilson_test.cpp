#include <gtest/gtest.h>

#include "analysis/statistics/descriptive.hpp"
#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

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
