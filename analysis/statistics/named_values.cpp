#include "analysis/statistics/named_values.hpp"

#include <cmath>

#include "common/error.hpp"

namespace thimble {

void refuse(std::string_view test, const std::string& what) {
    throw Error(ExitCode::kData, std::string(test) + ": " + what);
}

void require_numbers(const NamedValues& column, std::string_view test) {
    for (std::size_t i = 0; i < column.values.size(); ++i) {
        if (std::abs(column.values[i]) <= kLargestValue) continue;
        refuse(test, "column '" + column.name + "' has no usable number in row " + std::to_string(i + 1) +
                         " (" + std::to_string(column.values[i]) + "); measure it or leave its row out");
    }
}

void require_at_least(const NamedValues& column, std::size_t least, std::string_view test) {
    if (column.values.size() >= least) return;
    refuse(test, "column '" + column.name + "' has " + std::to_string(column.values.size()) +
                     " values and needs at least " + std::to_string(least) + "; measure more");
}

void require_confidence(double confidence, std::string_view test) {
    if (confidence > 0 && confidence < 1) return;
    refuse(test, "a confidence of " + std::to_string(confidence) + " is not inside (0, 1); 0.95 is usual");
}

}  // namespace thimble
