// Differences of two columns, subject by subject: what every paired test starts from.
#pragma once

#include <string_view>

#include "analysis/statistics/moments.hpp"
#include "analysis/statistics/named_values.hpp"

namespace thimble {

struct PairedDifferences {
    Moments moments;     // of first minus second
    double largest = 0;  // magnitude of a value of either column
};

// The columns are of equal, non-zero length and hold numbers.
PairedDifferences paired_differences(const NamedValues& first, const NamedValues& second);

// Of at least two subjects whose differences are not all the same. Throws Error (kData) that names `test` and
// both columns otherwise, for columns of unequal length and for missing values.
Moments spread_differences(const NamedValues& first, const NamedValues& second, std::string_view test);

}  // namespace thimble
