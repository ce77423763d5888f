// Friedman's test: do conditions differ, judged by the ranks within each subject? With the exact null
// distribution, which at small n is what counts: n = 10, k = 4 and chi-squared = 18 is P = 7e-5, where
// chi-squared says 4e-4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/statistics/sample_table.hpp"

namespace thimble {

struct Friedman {
    // Corrected for ties: (k - 1) sum_j (R_j - n (k + 1) / 2)^2 / sum_ij (r_ij - (k + 1) / 2)^2 with ranks r_ij
    // in row i (ties share their mean) and their sums R_j (Conover, "Practical nonparametric statistics", 3rd
    // ed. 1999, section 5.8).
    double chi_squared = 0;
    double df = 0;            // k - 1
    double p_asymptotic = 1;  // of chi-squared with k - 1 degrees of freedom
    // P(chi_squared at least as large), every arrangement of each subject's own ranks equally likely: exact
    // also with ties, given the ties. Nothing if beyond kFriedmanExactSteps or 64-bit states.
    std::optional<double> p_exact;
    double kendalls_w =
        0;  // chi_squared / (n (k - 1)): 0 no agreement of the subjects' orders, 1 the same order
    std::vector<double> mean_ranks;  // of each condition; 1 for the smallest value

    double p() const { return p_exact.value_or(p_asymptotic); }
};

// The exact distribution is given up after this many steps (one arrangement of one subject's ranks added to
// one state), about half a second. It reaches n = 30 with 4 conditions, 10 with 5, 5 with 6 where nothing ties.
inline constexpr std::size_t kFriedmanExactSteps = 5'000'000;

// At least 2 subjects and 2 conditions; throws Error (kData) otherwise and where every subject has the same
// value in all conditions.
Friedman friedman(const SampleTable& table);

struct DunnPair {
    std::size_t first = 0;  // of the conditions, first < second
    std::size_t second = 0;
    double mean_rank_difference = 0;  // first minus second
    double z = 0;                     // |mean_rank_difference| / sqrt(k (k + 1) / (6 n))
    double p = 1;                     // two-sided, of this pair alone
    double p_adjusted = 1;            // times the number of pairs, at most 1
};

// Dunn's comparisons after Friedman's test, as GraphPad Prism makes them: Dunn, "Multiple comparisons using
// rank sums", Technometrics 6(3), 1964. The standard error knows no ties: with many the test is conservative.
// Errors as friedman's.
std::vector<DunnPair> dunn_after_friedman(const SampleTable& table);

// Twice the rank (1 for the smallest) of each value, in the values' order. Only equal doubles tie, and share their mean
// rank: twice it is a whole number, so that sums compare exactly.
std::vector<std::int64_t> doubled_ranks(std::span<const double> values);

// The exact null distribution of Friedman's statistic, also with ties (given the ties).

// P(sum_j (R_j - mean)^2 >= spread) where R_j are the column sums of `rows` and every distinct arrangement of
// each row is equally likely. rows: doubled ranks of each subject, all of the same length. A tail is a sum of
// positive terms, so it keeps its digits down to 1e-300.
//
// Subject by subject, as Kendall and Babington Smith built their tables ("The problem of m rankings", Annals of
// Mathematical Statistics 10, 1939); the state is the sorted column sums, because the conditions are
// exchangeable. Rows in one order, so that the order of the subjects changes no bit. Nothing if it needs more
// than `most_steps` (arrangement added to state), or sums that do not pack into 64 bits.
std::optional<double> friedman_exact_p(const std::vector<std::vector<std::int64_t>>& rows,
                                       std::int64_t spread, std::size_t most_steps);

}  // namespace thimble
