#include "analysis/statistics/equivalence.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(Equivalence, AgreesWithStatsmodels) {
    for (const auto& g : golden("pairs")) {
        SCOPED_TRACE(g.at("name"));
        const Equivalence result = equivalence(column("a", g.at("first")), column("b", g.at("second")),
                                               {g.at("bounds")[0], g.at("bounds")[1]});
        EXPECT_TRUE(close(result.difference, g.at("difference"), 1e-10));
        EXPECT_EQ(result.df, g.at("df").get<double>());
        EXPECT_TRUE(close(result.t_low, g.at("t")[0], 1e-10));
        EXPECT_TRUE(close(result.t_high, g.at("t")[1], 1e-10));
        EXPECT_TRUE(close(result.p_low, g.at("p")[0], 1e-9));
        EXPECT_TRUE(close(result.p_high, g.at("p")[1], 1e-9));
        EXPECT_TRUE(close(result.interval.low, g.at("interval_90")[0], 1e-9));
        EXPECT_TRUE(close(result.interval.high, g.at("interval_90")[1], 1e-9));
        EXPECT_EQ(result.p(), std::max(result.p_low, result.p_high));
        const bool inside =
            result.interval.low > g.at("bounds")[0] && result.interval.high < g.at("bounds")[1];
        EXPECT_EQ(result.p() < 0.05, inside);
    }
}

TEST(Equivalence, ByHand) {
    // Differences -1, 0, 1: mean 0, standard error 1 / sqrt(3); against -+2, t = 2 sqrt(3) both ways.
    const Equivalence result = equivalence({"a", {0, 5, 3}}, {"b", {1, 5, 2}}, {-2, 2});
    EXPECT_DOUBLE_EQ(result.t_low, 2 * std::sqrt(3.0));
    EXPECT_EQ(result.t_high, -result.t_low);
    EXPECT_EQ(result.p_low, result.p_high);
    // Two degrees of freedom: P(T >= t) = (1 - t / sqrt(2 + t^2)) / 2.
    EXPECT_TRUE(close(result.p(), (1 - std::sqrt(12.0 / 14)) / 2, 1e-13));
}

TEST(Equivalence, Refuses) {
    const NamedValues hf{"HF", {1, 2, 4}};
    const NamedValues cf{"CF", {1, 3, 2}};
    expect_refused([&] { equivalence(hf, cf, {1, -1}); }, {"bounds", "ascending"});
    expect_refused([&] { equivalence(hf, cf, {0, 0}); }, {"bounds", "ascending"});
    expect_refused([&] { equivalence(hf, cf, {kMissing, 1}); }, {"bounds"});
    expect_refused([&] { equivalence(hf, cf, {-1, 1}, 0.5); }, {"alpha"});
    expect_refused([&] { equivalence(hf, hf, {-1, 1}); }, {"HF", "same amount"});
    expect_refused([&] { equivalence(hf, {"CF", {1, 2}}, {-1, 1}); }, {"HF", "CF", "3 values"});
}

}  // namespace
}  // namespace thimble
