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

Equivalence equivalence(const NamedValues& first, const NamedValues& second, EquivalenceBounds bounds,
                        double alpha) {
    constexpr const char* kWhat = "equivalence test";
    if (!(bounds.low < bounds.high && std::isfinite(bounds.low) && std::isfinite(bounds.high))) {
        refuse(kWhat, "bounds " + std::to_string(bounds.low) + " and " + std::to_string(bounds.high) +
                          " are not finite and ascending");
    }
    if (!(alpha > 0 && alpha < 0.5)) {
        refuse(kWhat, "alpha = " + std::to_string(alpha) + " is not inside (0, 0.5); 0.05 is usual");
    }
    const Moments m = spread_differences(first, second, kWhat);
    const auto n = static_cast<double>(m.n);
    const double standard_error = std::sqrt(m.variance() / n);
    Equivalence result;
    result.difference = m.mean;
    result.df = n - 1;
    result.t_low = (m.mean - bounds.low) / standard_error;
    result.t_high = (m.mean - bounds.high) / standard_error;
    result.p_low = t_upper(result.t_low, result.df);
    result.p_high = t_upper(-result.t_high, result.df);
    const double half = t_half_width(1 - 2 * alpha, result.df) * standard_error;
    result.interval = {m.mean - half, m.mean + half};
    return result;
}

}  // namespace thimble
