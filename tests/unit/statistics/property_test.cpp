// Properties for any data.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/friedman.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

using Columns = std::vector<std::vector<double>>;

// Thousandths between -4 and 4; few distinct values (whole ones) make ties.
Columns random_columns(std::size_t subjects, std::size_t conditions, bool ties) {
    Columns values(conditions);
    for (auto& column : values) {
        for (std::size_t s = 0; s < subjects; ++s) {
            const int drawn = *rc::gen::inRange(-4000, 4000);
            column.push_back(ties ? drawn / 1000 : 0.001 * drawn);
        }
    }
    return values;
}

Columns random_columns(bool ties = false) {
    return random_columns(*rc::gen::inRange<std::size_t>(3, 9), *rc::gen::inRange<std::size_t>(2, 5), ties);
}

bool all_columns_equal(const Columns& values) {
    return std::all_of(values.begin(), values.end(), [&](const auto& column) { return column == values[0]; });
}

// Untied data with an error term.
void assume_error(const Columns& values) {
    try {
        repeated_anova(table(values));
    } catch (const Error&) {
        RC_DISCARD("no error term");
    }
}

Columns shuffled_subjects(const Columns& values) {
    std::vector<std::size_t> order(values.front().size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (std::size_t i = order.size() - 1; i > 0; --i) {
        std::swap(order[i], order[*rc::gen::inRange<std::size_t>(0, i + 1)]);
    }
    Columns shuffled(values.size());
    for (std::size_t c = 0; c < values.size(); ++c) {
        for (const std::size_t s : order) shuffled[c].push_back(values[c][s]);
    }
    return shuffled;
}

bool near(double a, double b, double relative = 1e-9, double absolute = 1e-12) {
    return std::abs(a - b) <= relative * std::abs(b) + absolute;
}

bool is_probability(double p) { return p >= 0 && p <= 1; }

void assert_same(const RepeatedAnova& a, const RepeatedAnova& b) {
    RC_ASSERT(near(a.f, b.f));
    RC_ASSERT(near(a.p, b.p));
    RC_ASSERT(near(a.epsilon_greenhouse_geisser, b.epsilon_greenhouse_geisser));
    RC_ASSERT(near(a.p_greenhouse_geisser, b.p_greenhouse_geisser));
}

TEST(StatisticsProperty, OrderOfTheSubjectsDoesNotMatter) {
    EXPECT_TRUE(rc::check("order of subjects", [] {
        const Columns values = random_columns();
        assume_error(values);
        const Columns shuffled = shuffled_subjects(values);
        assert_same(repeated_anova(table(shuffled)), repeated_anova(table(values)));
    }));
}

TEST(StatisticsProperty, OrderOfTheSubjectsChangesNoBitOfFriedman) {
    EXPECT_TRUE(rc::check("order of subjects, ranks", [] {
        const Columns values = random_columns(*rc::gen::arbitrary<bool>());
        RC_PRE(!all_columns_equal(values));
        const Friedman one = friedman(table(values));
        const Friedman other = friedman(table(shuffled_subjects(values)));
        RC_ASSERT(one.chi_squared == other.chi_squared);
        RC_ASSERT(one.p_exact == other.p_exact);
    }));
}

TEST(StatisticsProperty, AConstantPerSubjectChangesNeitherFNorEpsilon) {
    EXPECT_TRUE(rc::check("constant per subject", [] {
        const Columns values = random_columns();
        assume_error(values);
        Columns moved = values;
        for (std::size_t s = 0; s < values.front().size(); ++s) {
            const double constant = *rc::gen::inRange(-1000, 1000);
            for (auto& column : moved) column[s] += constant;
        }
        assert_same(repeated_anova(table(moved)), repeated_anova(table(values)));
    }));
}

TEST(StatisticsProperty, UnitsDoNotMatter) {
    EXPECT_TRUE(rc::check("units", [] {
        const Columns values = random_columns();
        assume_error(values);
        const double factor = std::exp2(*rc::gen::inRange(-60, 60));  // exact: the same bits
        Columns scaled = values;
        for (auto& column : scaled) {
            for (double& value : column) value *= factor;
        }
        const RepeatedAnova one = repeated_anova(table(values));
        const RepeatedAnova other = repeated_anova(table(scaled));
        RC_ASSERT(one.f == other.f);
        RC_ASSERT(one.p == other.p);
        RC_ASSERT(near(one.epsilon_greenhouse_geisser, other.epsilon_greenhouse_geisser, 1e-13));
        RC_ASSERT(one.partial_eta_squared == other.partial_eta_squared);
    }));
}

TEST(StatisticsProperty, FriedmanSeesRanksOnly) {
    EXPECT_TRUE(rc::check("monotone transforms per subject", [] {
        const Columns values = random_columns(*rc::gen::arbitrary<bool>());
        RC_PRE(!all_columns_equal(values));
        Columns bent = values;
        for (std::size_t s = 0; s < values.front().size(); ++s) {
            const int shape = *rc::gen::inRange(0, 3);
            const double shift = *rc::gen::inRange(-5, 5);
            for (auto& column : bent) {
                double& x = column[s];
                x = shape == 0 ? std::exp(x) : shape == 1 ? x * x * x : 3 * x;
                x += shift;
            }
        }
        const Friedman one = friedman(table(values));
        const Friedman other = friedman(table(bent));
        RC_ASSERT(one.chi_squared == other.chi_squared);
        RC_ASSERT(one.p_exact == other.p_exact);
        RC_ASSERT(one.mean_ranks == other.mean_ranks);
    }));
}

TEST(StatisticsProperty, ResultsStayInTheirRanges) {
    EXPECT_TRUE(rc::check("ranges", [] {
        const Columns values = random_columns();
        assume_error(values);
        const auto k = static_cast<double>(values.size());
        const RepeatedAnova anova = repeated_anova(table(values));
        RC_ASSERT(is_probability(anova.p) && is_probability(anova.p_greenhouse_geisser));
        RC_ASSERT(is_probability(anova.p_huynh_feldt));
        RC_ASSERT(anova.epsilon_greenhouse_geisser >= 1 / (k - 1));
        RC_ASSERT(anova.epsilon_greenhouse_geisser <= anova.epsilon_huynh_feldt);
        RC_ASSERT(anova.epsilon_huynh_feldt <= 1);
        RC_ASSERT(anova.generalised_eta_squared <= anova.partial_eta_squared);
        RC_ASSERT(anova.partial_eta_squared <= 1 && anova.generalised_eta_squared >= 0);
        const Friedman ranks = friedman(table(values));
        RC_ASSERT(is_probability(ranks.p_asymptotic) && is_probability(ranks.p()));
        RC_ASSERT(ranks.kendalls_w >= 0 && ranks.kendalls_w <= 1);
        for (const DunnPair& pair : dunn_after_friedman(table(values))) {
            RC_ASSERT(is_probability(pair.p) && is_probability(pair.p_adjusted) && pair.p <= pair.p_adjusted);
        }
    }));
}

TEST(StatisticsProperty, IntervalsHoldTheirEstimateAndAgreeWithP) {
    EXPECT_TRUE(rc::check("pairs", [] {
        const Columns values = random_columns();
        assume_error(values);
        for (const MeanPair& pair : pairs_after_repeated_anova(table(values))) {
            RC_ASSERT(is_probability(pair.p));
            RC_ASSERT(pair.p <= pair.p_holm && pair.p_holm <= pair.p_bonferroni && pair.p_bonferroni <= 1);
            RC_ASSERT(pair.interval_simultaneous.low <= pair.interval.low);
            RC_ASSERT(pair.interval.low <= pair.difference && pair.difference <= pair.interval.high);
            RC_ASSERT(pair.interval.high <= pair.interval_simultaneous.high);
            if (std::abs(pair.p_bonferroni - 0.05) < 1e-9 || std::abs(pair.p - 0.05) < 1e-9) continue;
            const auto excludes_zero = [](ConfidenceInterval i) { return i.low > 0 || i.high < 0; };
            RC_ASSERT(excludes_zero(pair.interval) == (pair.p < 0.05));
            RC_ASSERT(excludes_zero(pair.interval_simultaneous) == (pair.p_bonferroni < 0.05));
        }
    }));
}

TEST(StatisticsProperty, HolmIsAtMostBonferroniAndKeepsTheOrder) {
    EXPECT_TRUE(rc::check("adjustments", [] {
        std::vector<double> p;
        for (const int drawn : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 1001))) {
            p.push_back(1e-3 * drawn > 1 ? 1 : 1e-3 * drawn);
        }
        const auto by_bonferroni = bonferroni(p);
        const auto by_holm = holm(p);
        for (std::size_t i = 0; i < p.size(); ++i) {
            RC_ASSERT(p[i] <= by_holm[i] && by_holm[i] <= by_bonferroni[i] && by_bonferroni[i] <= 1);
            for (std::size_t j = 0; j < p.size(); ++j) RC_ASSERT(p[i] > p[j] || by_holm[i] <= by_holm[j]);
        }
    }));
}

TEST(StatisticsProperty, WilsonHoldsTheProportionAndMirrors) {
    EXPECT_TRUE(rc::check("Wilson", [] {
        const auto trials = *rc::gen::inRange<std::size_t>(1, 2000);
        const auto successes = *rc::gen::inRange<std::size_t>(0, trials + 1);
        const auto interval = wilson_interval(successes, trials);
        const double proportion = static_cast<double>(successes) / static_cast<double>(trials);
        RC_ASSERT(0 <= interval.low && interval.low <= proportion);
        RC_ASSERT(proportion <= interval.high && interval.high <= 1);
        const auto mirrored = wilson_interval(trials - successes, trials);
        RC_ASSERT(near(1 - mirrored.high, interval.low));
    }));
}

}  // namespace
}  // namespace thimble
