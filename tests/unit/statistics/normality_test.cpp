#include "analysis/statistics/normality.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(Normality, AgreesWithScipy) {
    for (const auto& g : golden("columns")) {
        SCOPED_TRACE(g.at("name"));
        const Normality result = normality(column("x", g.at("values")));
        EXPECT_TRUE(close(result.skewness, g.at("skewness"), 1e-10, 1e-13));
        EXPECT_TRUE(close(result.kurtosis, g.at("kurtosis"), 1e-10));
        EXPECT_TRUE(close(result.z_skewness, g.at("z_skewness"), 1e-10, 1e-13));
        EXPECT_TRUE(close(result.z_kurtosis, g.at("z_kurtosis"), 1e-9, 1e-12));
        EXPECT_TRUE(close(result.k2, g.at("k2"), 1e-10));
        EXPECT_TRUE(close(result.p, g.at("p"), 1e-9));
    }
}

TEST(Normality, TellsTheExponentialFromTheNormal) {
    std::vector<double> normal;
    std::vector<double> exponential;
    for (const auto& g : golden("columns")) {
        if (g.at("name") == "c.normal") normal = numbers(g.at("values"));
        if (g.at("name") == "c.exponential") exponential = numbers(g.at("values"));
    }
    EXPECT_GT(normality({"x", normal}).p, 0.05);
    EXPECT_LT(normality({"x", exponential}).p, 0.001);
}

TEST(Normality, SymmetricDataHaveNoSkewness) {
    // SciPy 1.10 replaces a skewness of exactly 0 by 1 on its way to z.
    const Normality result = normality({"x", {-4, -3, -2, -1, 1, 2, 3, 4}});
    EXPECT_EQ(result.skewness, 0);
    EXPECT_EQ(result.z_skewness, 0);
    // m2 = 60 / 8, m4 = 708 / 8.
    EXPECT_TRUE(close(result.kurtosis, 88.5 / (7.5 * 7.5), 1e-14));
    EXPECT_EQ(result.k2, result.z_kurtosis * result.z_kurtosis);
    EXPECT_TRUE(close(result.p, std::exp(-result.k2 / 2), 1e-13));
}

TEST(Normality, MirroringTurnsTheSkewnessRound) {
    const std::vector<double> values{0, 1, 1, 2, 3, 5, 8, 13, 21};
    std::vector<double> mirrored;
    for (const double value : values) mirrored.push_back(-value);
    const Normality one = normality({"x", values});
    const Normality other = normality({"x", mirrored});
    EXPECT_EQ(one.z_skewness, -other.z_skewness);
    EXPECT_EQ(one.p, other.p);
    EXPECT_GT(one.z_skewness, 0);
}

TEST(Normality, Refuses) {
    expect_refused([] { normality({"time", {1, 2, 3, 4, 5, 6, 7}}); }, {"time", "7 values", "at least 8"});
    expect_refused([] { normality({"time", std::vector<double>(20, 0.1)}); }, {"time", "constant"});
    expect_refused([] { normality({"time", {1, 2, 3, 4, 5, 6, 7, kMissing}}); }, {"time", "row 8"});
    std::vector<double> coin;
    for (int i = 0; i < 40; ++i) coin.push_back(i % 2);
    expect_refused([&] { normality({"beeped", coin}); }, {"beeped", "two values", "not normal"});
}

}  // namespace
}  // namespace thimble
