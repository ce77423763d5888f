// Mean and sum of squares in two passes (Chan, Golub and LeVeque, "Algorithms for computing the sample
// variance", The American Statistician 37(3), 1983), the mean with twice the digits: a common offset then costs
// no digits of the spread, nor of the difference of two means.
#pragma once

#include <cstddef>
#include <span>

namespace thimble {

struct Moments {
    std::size_t n = 0;
    double mean = 0;
    double mean_rest = 0;  // what rounding took from the mean: its next digits
    double squares = 0;    // sum of squared deviations from the mean
    double largest = 0;    // largest magnitude

    double variance() const { return squares / static_cast<double>(n - 1); }  // n >= 2
};

Moments moments(std::span<const double> values);

// Whether a sum of squared deviations is no more than the rounding of numbers of magnitude `largest`: eight
// half-ulps each. Then the deviations are zero for all that the data can tell, and ratios of them are noise.
bool at_rounding(double squares, std::size_t n, double largest);
bool at_rounding(const Moments& moments);

// Differences that keep the digits that the rounded means have lost.
inline double deviation(double value, const Moments& from) { return (value - from.mean) - from.mean_rest; }
inline double mean_difference(const Moments& a, const Moments& b) {
    return (a.mean - b.mean) + (a.mean_rest - b.mean_rest);
}

}  // namespace thimble
