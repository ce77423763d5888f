// A column of measurements with the name it has in the errors. All values of one column share a unit; results
// that carry a unit (means, differences, intervals) carry that one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace thimble {

struct NamedValues {
    std::string name;
    std::vector<double> values;
};

struct ConfidenceInterval {
    double low = 0;
    double high = 0;
};

// Beyond this magnitude squares of differences overflow.
inline constexpr double kLargestValue = 1e150;

// Each throws Error (kData) that names `test` and the column. `test` is what the caller is about to compute.
void require_numbers(const NamedValues& column, std::string_view test);  // finite, at most kLargestValue
void require_at_least(const NamedValues& column, std::size_t least, std::string_view test);
// Of a confidence interval: inside (0, 1).
void require_confidence(double confidence, std::string_view test);

[[noreturn]] void refuse(std::string_view test, const std::string& what);

}  // namespace thimble
