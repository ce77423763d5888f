#include "analysis/statistics/descriptive.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/moments.hpp"

namespace thimble {
namespace {

Moments checked_moments(const NamedValues& column, std::size_t least, std::string_view what) {
    require_numbers(column, what);
    require_at_least(column, least, what);
    return moments(column.values);
}

}  // namespace

double sample_mean(const NamedValues& column) { return checked_moments(column, 1, "mean").mean; }

double sample_sd(const NamedValues& column) {
    return std::sqrt(checked_moments(column, 2, "standard deviation").variance());
}

double sample_quantile(const NamedValues& column, double p) {
    constexpr const char* kWhat = "quantile";
    require_numbers(column, kWhat);
    require_at_least(column, 1, kWhat);
    if (!(p >= 0 && p <= 1)) refuse(kWhat, "p = " + std::to_string(p) + " is not in [0, 1]");
    std::vector<double> sorted = column.values;
    std::sort(sorted.begin(), sorted.end());
    const double place = static_cast<double>(sorted.size() - 1) * p;
    const double below = std::floor(place);
    const auto i = static_cast<std::size_t>(below);
    if (i + 1 == sorted.size()) return sorted[i];
    return sorted[i] + (place - below) * (sorted[i + 1] - sorted[i]);
}

double sample_median(const NamedValues& column) { return sample_quantile(column, 0.5); }

ConfidenceInterval mean_interval(const NamedValues& column, double confidence) {
    constexpr const char* kWhat = "confidence interval of a mean";
    require_confidence(confidence, kWhat);
    const Moments m = checked_moments(column, 2, kWhat);
    const auto n = static_cast<double>(m.n);
    const double half = t_half_width(confidence, n - 1) * std::sqrt(m.variance() / n);
    return {m.mean - half, m.mean + half};
}

}  // namespace thimble
