// How far one condition lies from another, by ranks: Hodges and Lehmann's estimate, its confidence interval and the exact
// test of no difference, all three from one procedure. So the interval excludes zero exactly when P is below the level.
//
// Wilcoxon, "Individual comparisons by ranking methods", Biometrics Bulletin 1(6), 1945; Hodges and Lehmann, "Estimates of
// location based on rank tests", Annals of Mathematical Statistics 34(2), 1963; intervals by inversion: Hollander, Wolfe and
// Chicken, "Nonparametric statistical methods", 3rd ed. 2014, sections 3.1 to 3.3 (paired) and 4.1 to 4.3 (two groups).
#pragma once

#include <cstddef>
#include <optional>

#include "analysis/statistics/named_values.hpp"

namespace thimble {

struct LocationShift {
    double estimate =
        0;  // first minus second, data's unit: the median of all averages, or of all differences
    // At 1 - level / family, ends included. Nothing where so few values cannot differ significantly.
    std::optional<ConfidenceInterval> interval;
    double p = 1;  // two-sided, times the family (Bonferroni), at most 1
    // Share of the averages (differences) above zero minus the share below: Kerby, "The simple difference formula",
    // Comprehensive Psychology 3, 2014. 1: all above.
    double rank_biserial = 0;
};

// `family`: comparisons made at once. The distribution is exact up to these sizes, beyond them normal with continuity
// correction. Ties and zeros get the order and the sign that speak least against no difference; the distribution is
// then that of untied ranks, and the test keeps its level. Throws Error (kData) for no value and for values that are no numbers.
inline constexpr std::size_t kSignedRankExact = 200;  // subjects
inline constexpr std::size_t kRankSumExact = 100;     // of both groups together

// Differences of the same subjects, first minus second.
LocationShift signed_rank(const NamedValues& differences, std::size_t family = 1, double level = 0.05);
// Independent groups.
LocationShift rank_sum(const NamedValues& first, const NamedValues& second, std::size_t family = 1,
                       double level = 0.05);

// Fewest subjects (values of each of two equal groups) with which any data can give P below the level.
std::size_t fewest_for_signed_rank(std::size_t family = 1, double level = 0.05);
std::size_t fewest_for_rank_sum(std::size_t family = 1, double level = 0.05);

}  // namespace thimble
