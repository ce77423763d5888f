#include "analysis/statistics/effect_size.hpp"

#include <gtest/gtest.h>

#include "analysis/statistics/distributions.hpp"
#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(EtaSquaredInterval, AgreesWithRAndMpmath) {
    for (const auto& g : golden("f")) {
        SCOPED_TRACE(g.at("f"));
        const auto interval = eta_squared_interval(g.at("f"), g.at("df")[0], g.at("df")[1]);
        EXPECT_TRUE(close(interval.low, g.at("interval")[0], 1e-9));
        EXPECT_TRUE(close(interval.high, g.at("interval")[1], 1e-9));
    }
}

TEST(EtaSquaredInterval, Edges) {
    const auto none = eta_squared_interval(0, 3, 45);
    EXPECT_EQ(none.low, 0);
    EXPECT_EQ(none.high, 0);
    EXPECT_EQ(eta_squared_interval(1, 3, 45).low, 0);
    const auto wide = eta_squared_interval(10, 3, 45, 0.99);
    const auto narrow = eta_squared_interval(10, 3, 45, 0.9);
    EXPECT_LT(wide.low, narrow.low);
    EXPECT_GT(wide.high, narrow.high);
}

TEST(EtaSquaredInterval, Refuses) {
    expect_refused([] { eta_squared_interval(-1, 3, 45); }, {"eta squared", "-1"});
    expect_refused([] { eta_squared_interval(kMissing, 3, 45); }, {"eta squared", "nan"});
    expect_refused([] { eta_squared_interval(kInfinite, 3, 45); }, {"eta squared", "inf"});
    expect_refused([] { eta_squared_interval(1, 0, 45); }, {"degrees of freedom"});
    expect_refused([] { eta_squared_interval(1, 3, 45, 1); }, {"(0, 1)"});
}

TEST(CohensDz, AgreesWithRAndMpmath) {
    for (const auto& g : golden("pairs")) {
        SCOPED_TRACE(g.at("name"));
        const CohensDz effect = cohens_dz(column("a", g.at("first")), column("b", g.at("second")));
        EXPECT_TRUE(close(effect.d_z, g.at("d_z"), 1e-10));
        EXPECT_TRUE(close(effect.interval.low, g.at("d_z_interval")[0], 1e-9, 1e-12));
        EXPECT_TRUE(close(effect.interval.high, g.at("d_z_interval")[1], 1e-9, 1e-12));
    }
}

TEST(CohensDz, ByHand) {
    // Differences 1, 2, 3: mean 2, sd 1.
    const CohensDz effect = cohens_dz({"a", {1, 7, 4}}, {"b", {0, 5, 1}});
    EXPECT_DOUBLE_EQ(effect.d_z, 2);
    EXPECT_LT(effect.interval.low, 2);
    EXPECT_GT(effect.interval.high, 2);
    // No difference of means: delta's interval is symmetric.
    const CohensDz none = cohens_dz({"a", {1, 2, 3, 4}}, {"b", {2, 1, 4, 3}});
    EXPECT_EQ(none.d_z, 0);
    EXPECT_TRUE(close(none.interval.low, -none.interval.high, 1e-13));
    // P(T <= 0) is that of a normal variable: delta = 1.96 exactly, d_z = delta / sqrt(4).
    EXPECT_TRUE(close(none.interval.high, 1.9599639845400542 / 2, 1e-12));
}

TEST(CohensDz, Refuses) {
    expect_refused([] { cohens_dz({"HF", {1, 2}}, {"CF", {0, 1}}); }, {"HF", "CF", "same amount"});
    expect_refused([] { cohens_dz({"HF", {1, 2}}, {"CF", {0}}); }, {"HF", "CF", "2 values"});
    expect_refused([] { cohens_dz({"HF", {1}}, {"CF", {0}}); }, {"HF", "at least 2"});
    expect_refused([] { cohens_dz({"HF", {1, 2}}, {"CF", {0, kMissing}}); }, {"CF", "row 2"});
    expect_refused([] { cohens_dz({"HF", {1, 2}}, {"CF", {0, 4}}, 0); }, {"(0, 1)"});
}

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
