#include "analysis/statistics/descriptive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/statistics/distributions.hpp"

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

// The ends are the roots of (p - hits / n)^2 = z^2 p (1 - p) / n, the lower one in the form that only adds.
ConfidenceInterval wilson_interval(std::size_t successes, std::size_t trials, double confidence) {
    constexpr const char* kWhat = "Wilson interval";
    require_confidence(confidence, kWhat);
    if (trials == 0) refuse(kWhat, "0 trials have no proportion; run some");
    if (successes > trials) {
        refuse(kWhat, std::to_string(successes) + " successes in " + std::to_string(trials) + " trials");
    }
    const auto n = static_cast<double>(trials);
    const auto hits = static_cast<double>(successes);
    const double z = -normal_quantile((1 - confidence) / 2);
    const double centre = 2 * hits + z * z;
    const double both = centre + z * std::sqrt(z * z + 4 * hits * (n - hits) / n);
    ConfidenceInterval interval{2 * hits * hits / (n * both), both / (2 * (n + z * z))};
    if (successes == trials) interval.high = 1;  // and not one rounding beside it
    return interval;
}

Moments moments(std::span<const double> values) {
    Moments result;
    result.n = values.size();
    if (values.empty()) return result;
    const auto n = static_cast<double>(values.size());
    double sum = 0;
    for (const double value : values) sum += value;
    const double first_guess = sum / n;
    double rest = 0;
    for (const double value : values) rest += value - first_guess;
    rest /= n;
    result.mean = first_guess + rest;
    result.mean_rest = (first_guess - result.mean) + rest;
    for (const double value : values) {
        const double from_mean = deviation(value, result);
        result.squares += from_mean * from_mean;
        result.largest = std::max(result.largest, std::abs(value));
    }
    return result;
}

bool at_rounding(double squares, std::size_t n, double largest) {
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * largest;
    constexpr double kLeast = 1e-290;  // below it squares lose their digits to underflow
    return !(squares > std::max(kLeast, static_cast<double>(n) * rounding * rounding));
}

bool at_rounding(const Moments& moments) { return at_rounding(moments.squares, moments.n, moments.largest); }

PairedDifferences paired_differences(const NamedValues& first, const NamedValues& second) {
    PairedDifferences result;
    std::vector<double> differences;
    differences.reserve(first.values.size());
    for (std::size_t i = 0; i < first.values.size(); ++i) {
        differences.push_back(first.values[i] - second.values[i]);
        result.largest = std::max({result.largest, std::abs(first.values[i]), std::abs(second.values[i])});
    }
    result.moments = moments(differences);
    return result;
}

Moments spread_differences(const NamedValues& first, const NamedValues& second, std::string_view test) {
    require_numbers(first, test);
    require_numbers(second, test);
    if (first.values.size() != second.values.size()) {
        refuse(test, "column '" + first.name + "' has " + std::to_string(first.values.size()) + " values, '" +
                         second.name + "' has " + std::to_string(second.values.size()) +
                         "; every subject needs one in each");
    }
    require_at_least(first, 2, test);
    const PairedDifferences differences = paired_differences(first, second);
    if (at_rounding(differences.moments.squares, differences.moments.n, differences.largest)) {
        refuse(test, "columns '" + first.name + "' and '" + second.name +
                         "' differ by the same amount in every subject, so there is no spread to judge by; "
                         "check where the values come from");
    }
    return differences.moments;
}

}  // namespace thimble
