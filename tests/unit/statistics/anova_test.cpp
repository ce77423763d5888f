#include "analysis/statistics/anova.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

// Of sums of squares: what is zero by the design comes out at the rounding of the others.
double rounding_of(const nlohmann::json& ss) {
    double largest = 0;
    for (const double one : numbers(ss)) largest = std::max(largest, one);
    return 1e-15 * largest;
}

TEST(OneWayAnova, AgreesWithRAndScipy) {
    for (const auto& g : golden("groups")) {
        SCOPED_TRACE(g.at("name"));
        const OneWayAnova anova = one_way_anova(golden_columns(g.at("groups")));
        const double rounding = rounding_of(g.at("ss"));
        EXPECT_TRUE(close(anova.ss_between, g.at("ss")[0], 1e-10, rounding));
        EXPECT_TRUE(close(anova.ss_within, g.at("ss")[1], 1e-10, rounding));
        EXPECT_TRUE(close(anova.f, g.at("f"), 1e-10, 1e-13));
        EXPECT_TRUE(close(anova.p, g.at("p"), 1e-9));
        EXPECT_TRUE(close(anova.eta_squared, g.at("eta_squared"), 1e-10, 1e-15));
        EXPECT_EQ(anova.df_between, g.at("df")[0].get<double>());
        EXPECT_EQ(anova.df_within, g.at("df")[1].get<double>());
    }
}

TEST(OneWayAnova, ByHand) {
    // Means 2, 3, 7 about 4: 3 (4 + 1 + 9) = 42 between, 2 in each group.
    const OneWayAnova anova = one_way_anova(columns({{1, 2, 3}, {2, 3, 4}, {6, 7, 8}}));
    EXPECT_DOUBLE_EQ(anova.ss_between, 42);
    EXPECT_DOUBLE_EQ(anova.ss_within, 6);
    EXPECT_DOUBLE_EQ(anova.f, 21);
    EXPECT_DOUBLE_EQ(anova.ms_within(), 1);
    EXPECT_DOUBLE_EQ(anova.eta_squared, 42.0 / 48);
    // With 2 numerator degrees of freedom the tail has a closed form: (1 + 2 f / df)^(-df / 2).
    EXPECT_TRUE(close(anova.p, 1.0 / 512, 1e-13));
}

TEST(OneWayAnova, Refuses) {
    expect_refused([] { one_way_anova(columns({{1, 2}})); }, {"one-way ANOVA", "1 groups"});
    expect_refused([] { one_way_anova(columns({{1, 2}, {}})); }, {"column 1", "0 values"});
    expect_refused([] { one_way_anova(columns({{1}, {2}})); }, {"single value"});
    expect_refused([] { one_way_anova(columns({{1, 1}, {2, 2, 2}})); }, {"column 0", "constant"});
    expect_refused([] { one_way_anova(columns({{0.1, 0.1, 0.1}, {0.3, 0.3, 0.3}})); }, {"constant"});
    const double above_1 = std::nextafter(1.0, 2.0);
    expect_refused([=] { one_way_anova(columns({{1, above_1}, {above_1, 1, 1}})); }, {"constant"});
    expect_refused([] { one_way_anova(columns({{1, 2}, {2, kMissing}})); }, {"column 1", "row 2"});
    expect_refused([] { one_way_anova(columns({{kInfinite, 2}, {2, 3}})); }, {"column 0", "row 1"});
}

TEST(RepeatedAnova, AgreesWithRAndStatsmodels) {
    for (const auto& g : golden("tables")) {
        SCOPED_TRACE(g.at("name"));
        const RepeatedAnova anova =
            repeated_anova(SampleTable::from_columns(golden_columns(g.at("columns"))));
        const auto& expected = g.at("anova");
        const double rounding = rounding_of(expected.at("ss"));
        EXPECT_TRUE(close(anova.ss_conditions, expected.at("ss")[0], 1e-10, rounding));
        EXPECT_TRUE(close(anova.ss_error, expected.at("ss")[1], 1e-10, rounding));
        EXPECT_TRUE(close(anova.ss_subjects, expected.at("ss")[2], 1e-10, rounding));
        EXPECT_TRUE(close(anova.f, expected.at("f"), 1e-10));
        EXPECT_TRUE(close(anova.p, expected.at("p"), 1e-9));
        EXPECT_EQ(anova.df_conditions, expected.at("df")[0].get<double>());
        EXPECT_EQ(anova.df_error, expected.at("df")[1].get<double>());
        EXPECT_TRUE(close(anova.epsilon_greenhouse_geisser, expected.at("epsilons")[0], 1e-10));
        EXPECT_TRUE(close(anova.epsilon_huynh_feldt, expected.at("epsilons")[1], 1e-9));
        EXPECT_TRUE(close(anova.p_greenhouse_geisser, expected.at("p_corrected")[0], 1e-9));
        EXPECT_TRUE(close(anova.p_huynh_feldt, expected.at("p_corrected")[1], 1e-8));
        EXPECT_TRUE(close(anova.partial_eta_squared, expected.at("partial_eta_squared"), 1e-10));
        EXPECT_TRUE(close(anova.generalised_eta_squared, expected.at("generalised_eta_squared"), 1e-10));
    }
}

TEST(RepeatedAnova, TwoConditionsArePairedT) {
    // Differences 1, 2, 3: mean 2, standard error 1 / sqrt(3), t^2 = 12, and no sphericity to violate.
    const RepeatedAnova anova = repeated_anova(table({{0, 5, 1}, {1, 7, 4}}));
    EXPECT_TRUE(close(anova.f, 12, 1e-14));
    EXPECT_EQ(anova.df_conditions, 1);
    EXPECT_EQ(anova.df_error, 2);
    EXPECT_EQ(anova.epsilon_greenhouse_geisser, 1);
    EXPECT_EQ(anova.epsilon_huynh_feldt, 1);
    EXPECT_EQ(anova.p, anova.p_greenhouse_geisser);
}

TEST(RepeatedAnova, OneResidualDirectionHasTheLeastEpsilon) {
    // Only the last condition deviates between subjects: one direction carries all residuals.
    const RepeatedAnova anova =
        repeated_anova(table({{1, 2, 3, 4}, {1, 2, 3, 4}, {1, 2, 3, 4}, {1, 5, 2, 9}}));
    EXPECT_TRUE(close(anova.epsilon_greenhouse_geisser, 1.0 / 3, 1e-14));
}

// Three subjects leave two directions of residuals, which share them equally here: no departure from sphericity can be seen,
// whichever way rounding goes.
TEST(RepeatedAnova, EqualSharesOfTheResidualDirectionsNeedNoCorrection) {
    constexpr double kThird_rad = 2 * std::numbers::pi / 3;
    for (int turn = 0; turn < 100; ++turn) {
        std::vector<std::vector<double>> conditions(5);
        for (int s = 0; s < 3; ++s) {
            const double c = std::cos(0.1 * turn + s * kThird_rad), d = std::sin(0.1 * turn + s * kThird_rad);
            const double u = 1 / std::sqrt(2.0), v = 1 / std::sqrt(6.0);
            const std::array<double, 5> row{u * c + v * d, v * d - u * c, -2 * v * d, 1, 2};
            for (std::size_t i = 0; i < row.size(); ++i) conditions[i].push_back(row[i]);
        }
        const RepeatedAnova anova = repeated_anova(table(conditions));
        EXPECT_TRUE(close(anova.epsilon_greenhouse_geisser, 0.5, 1e-14));
        EXPECT_EQ(anova.epsilon_huynh_feldt, 1) << turn;
    }
}

TEST(RepeatedAnova, Refuses) {
    expect_refused([] { repeated_anova(table({{1, 2}, {2, 5}})); }, {"2 subjects", "at least 3"});
    expect_refused([] { repeated_anova(table({{1, 2, 4}})); }, {"1 conditions", "column 0"});
    expect_refused([] { repeated_anova(table({{1, 2, 3}, {1, 2, 3}})); }, {"column 0", "same amount"});
    // Additive up to rounding: 0.1 steps are no doubles.
    expect_refused(
        [] {
            repeated_anova(table({{0.1, 0.2, 0.7}, {0.4, 0.5, 1.0}, {0.2, 0.3, 0.8}}));
        },
        {"same amount"});
}

}  // namespace
}  // namespace thimble
