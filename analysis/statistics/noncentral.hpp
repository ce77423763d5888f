// Confidence intervals of noncentrality parameters by inverting the noncentral distribution at the observed
// statistic (Steiger and Fouladi, "Noncentrality interval estimation", in Harlow et al., "What if there were
// no significance tests?", 1997).
#pragma once

#include "analysis/statistics/confidence_interval.hpp"

namespace thimble {

// Of delta, where the statistic is distributed as noncentral t with `df` and delta. Finite t, df > 0.
ConfidenceInterval noncentrality_of_t(double t, double df, double confidence);

// Of lambda >= 0, where the statistic is distributed as noncentral F. An end at which even lambda = 0 puts too
// much probability beyond f is 0. Finite f >= 0.
ConfidenceInterval noncentrality_of_f(double f, double df_1, double df_2, double confidence);

}  // namespace thimble
