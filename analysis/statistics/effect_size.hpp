// How large an effect is, with confidence intervals from noncentral distributions. No units. The eta squared
// themselves stand in anova.hpp.
#pragma once

#include "analysis/statistics/confidence_interval.hpp"
#include "analysis/statistics/named_values.hpp"

namespace thimble {

// Of (partial) eta squared behind an observed F: lambda / (lambda + df_1 + df_2 + 1), lambda the noncentrality's
// interval (Smithson, "Confidence intervals", 2003). For independent groups df_1 + df_2 + 1 is the
// number of values; for repeated measures it assumes sphericity. An end is 0 where even no effect makes an F
// this large too easily. f finite and >= 0, degrees of freedom positive; throws Error (kData) otherwise.
ConfidenceInterval eta_squared_interval(double f, double df_1, double df_2, double confidence = 0.95);

struct CohensDz {
    double d_z = 0;  // mean / sd of the differences, first minus second (Cohen 1988, section 2.3.5)
    // From noncentral t with n - 1 degrees of freedom and delta = d_z sqrt(n) (Cumming and Finch, Educational
    // and Psychological Measurement 61(4), 2001).
    ConfidenceInterval interval;
};

// Of at least 2 subjects, value s of each column being subject s. Throws Error (kData) for unequal columns,
// missing values, and where the columns differ by the same amount in every subject.
CohensDz cohens_dz(const NamedValues& first, const NamedValues& second, double confidence = 0.95);

}  // namespace thimble
