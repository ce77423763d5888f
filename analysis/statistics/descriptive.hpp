// One column described, in its unit, and a proportion. Every function throws Error (kData) for a value that is
// missing or infinite and for too few values.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "analysis/statistics/named_values.hpp"

namespace thimble {

double sample_mean(const NamedValues& column);  // n >= 1
double sample_sd(const NamedValues& column);    // divisor n - 1; n >= 2; 0 for equal values

// Linear between order statistics at (n - 1) p (Hyndman and Fan, "Sample quantiles in statistical packages",
// The American Statistician 50(4), 1996, definition 7: R's and NumPy's default). p in [0, 1], n >= 1.
double sample_quantile(const NamedValues& column, double p);
double sample_median(const NamedValues& column);

// mean -+ t sd / sqrt(n), Student's t with n - 1 degrees of freedom; n >= 2. Equal values give no width.
ConfidenceInterval mean_interval(const NamedValues& column, double confidence = 0.95);

// Wilson's score interval of a proportion, without continuity correction: Wilson, "Probable inference, the law of
// succession, and statistical inference", JASA 22, 1927. Sensible also at 0 and 1 and for few trials. Inside [0, 1];
// starts at exactly 0 without a success and ends at exactly 1 without a failure. Throws Error (kData) for no trials and
// for more successes than trials.
ConfidenceInterval wilson_interval(std::size_t successes, std::size_t trials, double confidence = 0.95);

// Mean and sum of squares in two passes (Chan, Golub and LeVeque, "Algorithms for computing the sample
// variance", The American Statistician 37(3), 1983), the mean with twice the digits: a common offset then costs
// no digits of the spread, nor of the difference of two means.

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

// Differences of two columns, subject by subject: what every paired test starts from.

struct PairedDifferences {
    Moments moments;     // of first minus second
    double largest = 0;  // magnitude of a value of either column
};

// The columns are of equal, non-zero length and hold numbers.
PairedDifferences paired_differences(const NamedValues& first, const NamedValues& second);

// At least two subjects, with unequal differences. Throws Error (kData) that names `test` and
// both columns otherwise, for columns of unequal length and for missing values.
Moments spread_differences(const NamedValues& first, const NamedValues& second, std::string_view test);

}  // namespace thimble
