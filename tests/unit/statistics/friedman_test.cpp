#include "analysis/statistics/friedman.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(Friedman, AgreesWithRScipyAndConvolution) {
    int with_exact = 0;
    for (const auto& g : golden("tables")) {
        SCOPED_TRACE(g.at("name"));
        const Friedman result = friedman(SampleTable::from_columns(golden_columns(g.at("columns"))));
        const auto& expected = g.at("friedman");
        EXPECT_TRUE(close(result.chi_squared, expected.at("chi_squared"), 1e-11));
        EXPECT_TRUE(close(result.p_asymptotic, expected.at("p"), 1e-10));
        if (expected.at("p_exact").is_number()) {
            ASSERT_TRUE(result.p_exact.has_value());
            EXPECT_TRUE(close(*result.p_exact, expected.at("p_exact"), 1e-11));
            ++with_exact;
        }
        const double most = static_cast<double>(g.at("columns")[0].size()) * result.df;
        EXPECT_TRUE(close(result.kendalls_w, result.chi_squared / most, 1e-15));
        for (std::size_t i = 0; i < result.mean_ranks.size(); ++i) {
            EXPECT_TRUE(close(result.mean_ranks[i], g.at("dunn").at("mean_ranks")[i], 1e-14));
        }
    }
    EXPECT_GE(with_exact, 10);
}

TEST(Friedman, BeyondTheLimitOnlyTheAsymptoticRemains) {
    for (const auto& g : golden("tables")) {
        if (g.at("name") != "t.beyond_exact") continue;
        const Friedman result = friedman(SampleTable::from_columns(golden_columns(g.at("columns"))));
        EXPECT_FALSE(result.p_exact.has_value());
        EXPECT_EQ(result.p(), result.p_asymptotic);
        return;
    }
    FAIL() << "no such data set";
}

TEST(Friedman, CompleteAgreement) {
    const Friedman result = friedman(table({{1, 2, 3, 4}, {2, 3, 4, 5}, {3, 4, 5, 6}}));
    EXPECT_EQ(result.chi_squared, 8);
    EXPECT_EQ(result.kendalls_w, 1);
    EXPECT_TRUE(close(*result.p_exact, 1.0 / 216, 1e-14));  // six orders that four subjects could agree on
    EXPECT_EQ(result.mean_ranks, (std::vector<double>{1, 2, 3}));
}

TEST(Friedman, EqualRankSumsAreP1) {
    const Friedman result = friedman(table({{1, 2}, {2, 1}}));
    EXPECT_EQ(result.chi_squared, 0);
    EXPECT_EQ(result.p_asymptotic, 1);
    EXPECT_EQ(*result.p_exact, 1);
}

TEST(Friedman, Refuses) {
    expect_refused([] { friedman(table({{1, 2}, {1, 2}})); }, {"Friedman", "column 0", "same value"});
    expect_refused([] { friedman(table({{1}, {2}})); }, {"1 subjects"});
    expect_refused([] { friedman(table({{1, 2}})); }, {"1 conditions"});
    expect_refused([] { dunn_after_friedman(table({{1, 2}, {1, 2}})); }, {"same value"});
}

TEST(Dunn, AgreesWithItsFormula) {
    for (const auto& g : golden("tables")) {
        SCOPED_TRACE(g.at("name"));
        const auto pairs = dunn_after_friedman(SampleTable::from_columns(golden_columns(g.at("columns"))));
        const auto& expected = g.at("dunn");
        ASSERT_EQ(pairs.size(), expected.at("z").size());
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            EXPECT_TRUE(close(pairs[i].z, expected.at("z")[i], 1e-12, 1e-14));
            EXPECT_TRUE(close(pairs[i].p, expected.at("p")[i], 1e-11));
            EXPECT_TRUE(close(pairs[i].p_adjusted, expected.at("p_adjusted")[i], 1e-11));
        }
    }
}

TEST(Dunn, TheThresholdsOfTheClaims) {
    // n = 10, k = 4: P below .05 / .01 / .001 from mean-rank differences of 1.523 / 1.813 / 2.174 on, so with
    // mean ranks in tenths from 1.6, 1.9 and 2.2 on, and not at 1.5, 1.8 and 2.1.
    const auto p_at = [](int tenths) {
        // Row by row, the first column above the second by 1 to 3 ranks, the rest between, adding up to tenths.
        std::vector<std::vector<double>> columns(4);
        for (int row = 0, left = tenths; row < 10; ++row) {
            const int gap = std::min(3, left - (9 - row));
            left -= gap;
            columns[0].push_back(1 + gap);
            columns[1].push_back(1);
            columns[2].push_back(gap == 1 ? 3 : 2);
            columns[3].push_back(gap == 3 ? 3 : 4);
        }
        const DunnPair pair = dunn_after_friedman(table(columns)).front();
        EXPECT_NEAR(pair.mean_rank_difference, 0.1 * tenths, 1e-12);
        return pair.p_adjusted;
    };
    EXPECT_GT(p_at(15), 0.05);
    EXPECT_LT(p_at(16), 0.05);
    EXPECT_GT(p_at(18), 0.01);
    EXPECT_LT(p_at(19), 0.01);
    EXPECT_GT(p_at(21), 0.001);
    EXPECT_LT(p_at(22), 0.001);
}

}  // namespace
}  // namespace thimble
