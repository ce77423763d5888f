// The exact null distribution of Friedman's statistic, also with ties (given the ties).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace thimble {

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
