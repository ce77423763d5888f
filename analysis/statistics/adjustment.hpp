// Adjustment of the P values of one family of comparisons. In the order given; each result is in [P, 1].
// Throws Error (kData) for a P outside [0, 1].
#pragma once

#include <vector>

namespace thimble {

// min(1, m P): Dunn, "Multiple comparisons among means", JASA 56, 1961.
std::vector<double> bonferroni(const std::vector<double>& p);

// Step-down, never larger than Bonferroni's: Holm, "A simple sequentially rejective multiple test procedure",
// Scandinavian Journal of Statistics 6(2), 1979.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace thimble
