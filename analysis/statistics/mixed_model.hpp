// A linear mixed model with a random intercept per group (subject), by restricted maximum likelihood:
//     y = X b + u_group + e,   u ~ N(0, variance_group),  e ~ N(0, variance_rest)
// N. M. Laird and J. H. Ware, "Random-effects models for longitudinal data", Biometrics 38(4), 1982; the likelihood profiled over the
// ratio of the standard deviations: D. Bates and others, "Fitting linear mixed-effects models using lme4", Journal of Statistical
// Software 67(1), 2015.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/statistics/named_values.hpp"

namespace thimble {

struct FixedEffect {
    std::string name;
    double estimate = 0, standard_error = 0;  // data's unit per unit of the column
    double z = 0, p = 1;                      // Wald's, two-sided: right for many groups
    ConfidenceInterval interval;              // 95 %, Wald's
};

struct MixedModel {
    std::vector<FixedEffect> effects;  // in the order of the columns
    double variance_group = 0, variance_rest = 0;
    double log_likelihood = 0;  // restricted
};

// `columns` of X, each as long as `values`; the intercept is one of them if there is to be one. `group` of each value, any numbers. Throws
// Error (kData) for columns of unequal length, values that are no numbers, fewer than two groups, no repeated group, columns that
// depend on each other, or no more values than columns.
MixedModel mixed_model(const NamedValues& values, const std::vector<NamedValues>& columns,
                       const std::vector<std::size_t>& group);

}  // namespace thimble
