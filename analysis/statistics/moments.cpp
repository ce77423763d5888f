#include "analysis/statistics/moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thimble {

Moments moments(std::span<const double> values) {
    Moments result;
    result.n = values.size();
    if (values.empty()) return result;
    const auto n = static_cast<double>(values.size());
    double sum = 0;
    for (const double value : values) sum += value;
    const double first_guess = sum / n;
    double rest = 0;
    for (const double value : values) rest += value - first_guess;
    rest /= n;
    result.mean = first_guess + rest;
    result.mean_rest = (first_guess - result.mean) + rest;
    for (const double value : values) {
        const double from_mean = deviation(value, result);
        result.squares += from_mean * from_mean;
        result.largest = std::max(result.largest, std::abs(value));
    }
    return result;
}

bool at_rounding(double squares, std::size_t n, double largest) {
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * largest;
    constexpr double kLeast = 1e-290;  // below it squares lose their digits to underflow
    return !(squares > std::max(kLeast, static_cast<double>(n) * rounding * rounding));
}

bool at_rounding(const Moments& moments) { return at_rounding(moments.squares, moments.n, moments.largest); }

}  // namespace thimble
