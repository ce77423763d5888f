#include "analysis/statistics/equivalence.hpp"

#include <cmath>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/distributions.hpp"

namespace thimble {

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
