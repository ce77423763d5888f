// Tail probabilities and quantiles of the distributions the tests refer to. Boost.Math evaluated in double (no
// promotion: the same bits from every compiler) and by complements, so that small tails keep their digits. Arguments
// must be numbers, degrees of freedom positive, probabilities in (0, 1). Each throws Error (kData) where it cannot
// compute a value.
#pragma once

#include "analysis/statistics/named_values.hpp"

namespace thimble {

double normal_two_sided(double z);    // P(|Z| >= |z|)
double normal_quantile(double p);     // z with P(Z <= z) = p
double t_upper(double t, double df);  // P(T >= t); the lower tail is t_upper(-t, df)
double t_two_sided(double t, double df);
// t with P(|T| <= t) = confidence: half the width of an interval in standard errors.
double t_half_width(double confidence, double df);
double f_upper(double f, double df_1, double df_2);     // P(F >= f), f >= 0
double f_quantile(double p, double df_1, double df_2);  // f with P(F <= f) = p
double chi_squared_upper(double x, double df);          // P(X >= x), x >= 0
double chi_squared_quantile(double p, double df);       // x with P(X <= x) = p

}  // namespace thimble
