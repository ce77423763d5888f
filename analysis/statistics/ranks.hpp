// Ranks with ties sharing their mean, doubled so that they are whole numbers: sums of them compare exactly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace thimble {

// Twice the rank (1 for the smallest) of each value, in the values' order. Only equal doubles tie.
std::vector<std::int64_t> doubled_ranks(std::span<const double> values);

// Sum of t^3 - t over groups of t equal values: what ties take from the variance of ranks.
double tie_correction(std::span<const double> values);

}  // namespace thimble
