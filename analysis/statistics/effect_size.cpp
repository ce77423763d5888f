#include "analysis/statistics/effect_size.hpp"

#include <cmath>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/distributions.hpp"

namespace thimble {

ConfidenceInterval eta_squared_interval(double f, double df_1, double df_2, double confidence) {
    if (!(f >= 0 && std::isfinite(f) && df_1 > 0 && df_2 > 0 && std::isfinite(df_1 + df_2))) {
        refuse("confidence interval of eta squared",
               "F(" + std::to_string(df_1) + ", " + std::to_string(df_2) + ") = " + std::to_string(f) +
                   " needs a finite F >= 0 and positive degrees of freedom");
    }
    const ConfidenceInterval lambda = noncentrality_of_f(f, df_1, df_2, confidence);
    const auto explained = [&](double l) { return l / (l + df_1 + df_2 + 1); };
    return {explained(lambda.low), explained(lambda.high)};
}

CohensDz cohens_dz(const NamedValues& first, const NamedValues& second, double confidence) {
    const Moments m = spread_differences(first, second, "Cohen's d_z");
    const double root_n = std::sqrt(static_cast<double>(m.n));
    const double d_z = m.mean / std::sqrt(m.variance());
    const ConfidenceInterval delta =
        noncentrality_of_t(d_z * root_n, static_cast<double>(m.n - 1), confidence);
    return {d_z, {delta.low / root_n, delta.high / root_n}};
}

}  // namespace thimble
