// One column described. In the unit of the column. Every function throws Error (kData) for a value that is
// missing or infinite and for too few values.
#pragma once

#include "analysis/statistics/confidence_interval.hpp"
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

}  // namespace thimble
