// Every pair of conditions after an analysis of variance. Differences and intervals in the data's unit.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/statistics/named_values.hpp"
#include "analysis/statistics/sample_table.hpp"

namespace thimble {

struct MeanPair {
    std::size_t first = 0;  // of the conditions or groups, in their order; first < second
    std::size_t second = 0;
    double difference = 0;        // mean of the first minus mean of the second
    ConfidenceInterval interval;  // of this pair alone
    ConfidenceInterval
        interval_simultaneous;  // of all pairs at once: 1 - (1 - confidence) / pairs (Bonferroni)
    double t = 0;               // difference / its standard error
    double df = 0;
    double p = 1;  // two-sided, of this pair alone
    double p_bonferroni = 1;
    double p_holm = 1;
};

// t with the error mean square of repeated_anova and its degrees of freedom, for all pairs: t = difference / sqrt(2
// ms_error / n), df = (n - 1)(k - 1). GraphPad Prism's way, which the paper used. It is right only under sphericity.
// Errors as repeated_anova's.
std::vector<MeanPair> pairs_after_repeated_anova(const SampleTable& table, double confidence = 0.95);

struct PairedTests {
    std::vector<MeanPair> pairs;       // those that can be tested, in their order
    std::vector<std::string> refused;  // of each other pair: why
};

// Paired t test of each pair by its own differences, df = n - 1: needs no sphericity. At least 2 subjects and
// 2 conditions. A pair that differs by the same amount in every subject has no t; the corrections of the others
// count it, with P = 1. Throws Error (kData) where no pair can be tested.
PairedTests paired_t_tests(const SampleTable& table, double confidence = 0.95);

// t with the mean square within groups: t = difference / sqrt(ms_within (1 / n_1 + 1 / n_2)), df = df_within.
// Errors as one_way_anova's.
std::vector<MeanPair> pairs_after_one_way_anova(const std::vector<NamedValues>& groups,
                                                double confidence = 0.95);

// Adjustment of the P values of one family of comparisons. In the order given; each result is in [P, 1].
// Throws Error (kData) for a P outside [0, 1].

// min(1, m P): Dunn, "Multiple comparisons among means", JASA 56, 1961.
std::vector<double> bonferroni(const std::vector<double>& p);

// Step-down, never larger than Bonferroni's: Holm, "A simple sequentially rejective multiple test procedure",
// Scandinavian Journal of Statistics 6(2), 1979.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace thimble
