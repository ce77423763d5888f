#include "analysis/statistics/paired_differences.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace thimble {

PairedDifferences paired_differences(const NamedValues& first, const NamedValues& second) {
    PairedDifferences result;
    std::vector<double> differences;
    differences.reserve(first.values.size());
    for (std::size_t i = 0; i < first.values.size(); ++i) {
        differences.push_back(first.values[i] - second.values[i]);
        result.largest = std::max({result.largest, std::abs(first.values[i]), std::abs(second.values[i])});
    }
    result.moments = moments(differences);
    return result;
}

Moments spread_differences(const NamedValues& first, const NamedValues& second, std::string_view test) {
    require_numbers(first, test);
    require_numbers(second, test);
    if (first.values.size() != second.values.size()) {
        refuse(test, "column '" + first.name + "' has " + std::to_string(first.values.size()) + " values, '" +
                         second.name + "' has " + std::to_string(second.values.size()) +
                         "; every subject needs one in each");
    }
    require_at_least(first, 2, test);
    const PairedDifferences differences = paired_differences(first, second);
    if (at_rounding(differences.moments.squares, differences.moments.n, differences.largest)) {
        refuse(test, "columns '" + first.name + "' and '" + second.name +
                         "' differ by the same amount in every subject, so there is no spread to judge by; "
                         "check where the values come from");
    }
    return differences.moments;
}

}  // namespace thimble
