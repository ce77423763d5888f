// Mann and Whitney's U test of two independent groups (Wilcoxon's rank sum test).
// Mann and Whitney, Annals of Mathematical Statistics 18, 1947.
#pragma once

#include <cstddef>
#include <optional>

#include "analysis/statistics/named_values.hpp"

namespace thimble {

struct MannWhitney {
    double u = 0;  // pairs in which the first group's value is larger, ties counting one half
    // P(first larger) + P(equal) / 2 of a pair drawn at random: u / (n_1 n_2), 0.5 without difference.
    double superiority = 0.5;
    double p_asymptotic = 1;  // two-sided, normal, corrected for ties and continuity
    // Two-sided, twice the smaller tail: without ties and with at most kMannWhitneyExact values per group.
    std::optional<double> p_exact;

    double p() const { return p_exact.value_or(p_asymptotic); }
};

inline constexpr std::size_t kMannWhitneyExact = 50;

// Groups of at least one value each; throws Error (kData) otherwise, for missing values, and where all values
// of both groups are equal.
MannWhitney mann_whitney(const NamedValues& first, const NamedValues& second);

}  // namespace thimble
