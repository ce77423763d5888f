#include "analysis/statistics/wilson.hpp"

#include <cmath>

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/named_values.hpp"

namespace thimble {
namespace {

// Roots of (p - hits / n)^2 = z^2 p (1 - p) / n, the lower one in the form that only adds.
ConfidenceInterval roots(double hits, double n, double z) {
    const double centre = 2 * hits + z * z;
    const double both = centre + z * std::sqrt(z * z + 4 * hits * (n - hits) / n);
    return {2 * hits * hits / (n * both), both / (2 * (n + z * z))};
}

}  // namespace

ConfidenceInterval wilson_interval(std::size_t successes, std::size_t trials, double confidence) {
    constexpr const char* kWhat = "Wilson interval";
    require_confidence(confidence, kWhat);
    if (trials == 0) refuse(kWhat, "0 trials have no proportion; run some");
    if (successes > trials) {
        refuse(kWhat, std::to_string(successes) + " successes in " + std::to_string(trials) + " trials");
    }
    const auto n = static_cast<double>(trials);
    const auto hits = static_cast<double>(successes);
    ConfidenceInterval interval = roots(hits, n, -normal_quantile((1 - confidence) / 2));
    if (successes == trials) interval.high = 1;  // and not one rounding beside it
    return interval;
}

}  // namespace thimble
