#include "analysis/statistics/pairwise.hpp"

#include <gtest/gtest.h>

#include "analysis/statistics/anova.hpp"
#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

// R works without the table's offset and loses up to `digits` to the subjects' spread.
void expect_pairs(const std::vector<MeanPair>& pairs, const nlohmann::json& expected, double digits) {
    ASSERT_EQ(pairs.size(), expected.at("p").size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const MeanPair& pair = pairs[i];
        const auto of = [&](const char* field) { return expected.at(field)[i].get<double>(); };
        // A difference near zero has no digits of its own: relative to the interval.
        const double rounding = digits * (of("high") - of("low"));
        EXPECT_TRUE(close(pair.difference, of("difference"), digits, rounding));
        EXPECT_TRUE(close(pair.t, of("t"), digits, digits));
        EXPECT_EQ(pair.df, of("df"));
        EXPECT_TRUE(close(pair.p, of("p"), 100 * digits));
        EXPECT_TRUE(close(pair.p_bonferroni, of("p_bonferroni"), 100 * digits));
        EXPECT_TRUE(close(pair.p_holm, of("p_holm"), 100 * digits));
        EXPECT_TRUE(close(pair.interval.low, of("low"), digits, rounding));
        EXPECT_TRUE(close(pair.interval.high, of("high"), digits, rounding));
        EXPECT_TRUE(close(pair.interval_simultaneous.low, of("low_all"), digits, rounding));
        EXPECT_TRUE(close(pair.interval_simultaneous.high, of("high_all"), digits, rounding));
    }
}

TEST(Pairwise, PooledAfterRepeatedAnovaAgreesWithR) {
    for (const auto& g : golden("tables")) {
        SCOPED_TRACE(g.at("name"));
        expect_pairs(pairs_after_repeated_anova(SampleTable::from_columns(golden_columns(g.at("columns")))),
                     g.at("pooled"), g.at("name") == "t.offset_of_subjects" ? 1e-9 : 1e-11);
    }
}

TEST(Pairwise, PairedTAgreesWithR) {
    int compared = 0;
    for (const auto& g : golden("tables")) {
        SCOPED_TRACE(g.at("name"));
        const SampleTable values = SampleTable::from_columns(golden_columns(g.at("columns")));
        if (g.at("paired").is_null()) continue;  // R refuses all pairs for one
        EXPECT_TRUE(paired_t_tests(values).refused.empty());
        expect_pairs(paired_t_tests(values).pairs, g.at("paired"), 1e-11);
        ++compared;
    }
    EXPECT_GE(compared, 10);
}

TEST(Pairwise, PooledAfterOneWayAnovaAgreesWithR) {
    for (const auto& g : golden("groups")) {
        SCOPED_TRACE(g.at("name"));
        expect_pairs(pairs_after_one_way_anova(golden_columns(g.at("groups"))), g.at("pooled"), 1e-11);
    }
}

TEST(Pairwise, TwoConditionsAreOneTestThreeTimes) {
    const SampleTable values = table({{0, 5, 1, 4}, {1, 7, 4, 4}});
    const MeanPair pooled = pairs_after_repeated_anova(values).front();
    const MeanPair paired = paired_t_tests(values).pairs.front();
    EXPECT_TRUE(close(pooled.t, paired.t, 1e-14));
    EXPECT_TRUE(close(pooled.t * pooled.t, repeated_anova(values).f, 1e-14));
    EXPECT_TRUE(close(pooled.p, repeated_anova(values).p, 1e-13));
    EXPECT_EQ(pooled.p, pooled.p_bonferroni);
    EXPECT_EQ(pooled.interval.low, pooled.interval_simultaneous.low);
    EXPECT_EQ(pooled.difference, -1.5);
}

TEST(Pairwise, EqualColumnsDoNotDiffer) {
    const auto pairs = pairs_after_repeated_anova(table({{1, 2, 4}, {1, 2, 4}, {2, 5, 4}}));
    EXPECT_EQ(pairs[0].difference, 0);
    EXPECT_EQ(pairs[0].t, 0);
    EXPECT_EQ(pairs[0].p, 1);
}

// Each other pair gets the test that it would have alone; the corrections are for all pairs that were asked about.
TEST(Pairwise, OnePairWithEqualDifferencesCostsOnlyItsOwnTest) {
    const std::vector<std::vector<double>> columns{
        {1, 5, 2, 8, 3}, {2, 3, 4, 4, 9}, {3, 4, 5, 5, 10}, {0, 6, 1, 9, 2}};
    const PairedTests tests = paired_t_tests(table(columns));
    ASSERT_EQ(tests.pairs.size(), 5U);
    std::vector<double> p{1};
    for (const MeanPair& pair : tests.pairs) {
        const MeanPair alone =
            paired_t_tests(table({columns[pair.first], columns[pair.second]})).pairs.front();
        EXPECT_EQ(pair.t, alone.t);
        EXPECT_EQ(pair.p, alone.p);
        EXPECT_EQ(pair.interval.low, alone.interval.low);
        EXPECT_LT(pair.interval_simultaneous.low, alone.interval_simultaneous.low);
        EXPECT_EQ(pair.p_bonferroni, std::min(1.0, 6 * alone.p));
        p.push_back(alone.p);
    }
    const std::vector<double> adjusted = holm(p);
    for (std::size_t i = 0; i < tests.pairs.size(); ++i) EXPECT_EQ(tests.pairs[i].p_holm, adjusted[i + 1]);
    ASSERT_EQ(tests.refused.size(), 1U);
    for (const char* words : {"column 1", "column 2", "same amount"})
        EXPECT_NE(tests.refused[0].find(words), std::string::npos) << tests.refused[0];
}

TEST(Pairwise, Refuses) {
    expect_refused([] { paired_t_tests(table({{1}, {2}})); }, {"paired t", "1 subjects"});
    expect_refused([] { paired_t_tests(table({{1, 2}})); }, {"paired t", "1 conditions"});
    expect_refused([] { paired_t_tests(table({{1, 2}, {2, 5}}), 1.0); }, {"(0, 1)"});
    // A tenth apart, but for what doubles of a million cannot hold.
    expect_refused(
        [] {
            paired_t_tests(table({{1e5 + 0.1, 1e6 + 0.1}, {1e5 + 0.2, 1e6 + 0.2}}));
        },
        {"column 0", "column 1", "same amount"});
    expect_refused([] { pairs_after_repeated_anova(table({{1, 2}, {2, 5}})); }, {"2 subjects"});
    expect_refused([] { pairs_after_one_way_anova(columns({{1}, {2}})); }, {"single value"});
}

TEST(Adjustment, AgreesWithR) {
    for (const auto& g : golden("adjustments")) {
        const std::vector<double> p = numbers(g.at("p"));
        SCOPED_TRACE(g.at("p").dump());
        const auto by_bonferroni = bonferroni(p);
        const auto by_holm = holm(p);
        for (std::size_t i = 0; i < p.size(); ++i) {
            EXPECT_TRUE(close(by_bonferroni[i], g.at("bonferroni")[i], 1e-15));
            EXPECT_TRUE(close(by_holm[i], g.at("holm")[i], 1e-15));
        }
    }
}

TEST(Adjustment, ByHand) {
    // 3 x .01, 2 x .03 and 1 x .04 that may not fall below the one before.
    EXPECT_EQ(holm({0.03, 0.01, 0.04}), (std::vector<double>{0.06, 0.03, 0.06}));
    EXPECT_EQ(bonferroni({0.25, 0.5}), (std::vector<double>{0.5, 1}));
    EXPECT_TRUE(holm({}).empty());
}

TEST(Adjustment, RefusesWhatIsNoProbability) {
    for (const double p : {-0.1, 1.1, kMissing}) {
        expect_refused([&] { bonferroni({0.5, p}); }, {"adjustment", "not in [0, 1]"});
        expect_refused([&] { holm({0.5, p}); }, {"adjustment", "not in [0, 1]"});
    }
}

}  // namespace
}  // namespace thimble
