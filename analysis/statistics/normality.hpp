// D'Agostino and Pearson's omnibus test of normality.
// Source: D'Agostino, Belanger and D'Agostino, "A suggestion for using powerful and informative tests of
// normality", The American Statistician 44(4), 1990: skewness as in D'Agostino, Biometrika 57, 1970; kurtosis
// as in Anscombe and Glynn, Biometrika 70, 1983.
#pragma once

#include "analysis/statistics/named_values.hpp"

namespace thimble {

struct Normality {
    double skewness = 0;    // sqrt(b1) = m3 / m2^(3/2), moments with divisor n
    double kurtosis = 0;    // b2 = m4 / m2^2; 3 for a normal distribution
    double z_skewness = 0;  // each about standard normal if the column is
    double z_kurtosis = 0;
    double k2 = 0;  // z_skewness^2 + z_kurtosis^2
    double p = 1;   // of K2, chi-squared with 2 degrees of freedom
};

// n >= 8, below which the approximation of the skewness is undefined or poor; its authors trust that of the
// kurtosis from n = 20 on. Throws Error (kData) for fewer values, a constant column, missing values,
// and for two equally frequent values with n >= 35, whose kurtosis lies outside the approximation.
Normality normality(const NamedValues& column);

}  // namespace thimble
