// The references for a sample.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace thimble::test {

// Kolmogorov-Smirnov: the largest distance between the sample's distribution function and `cdf`.
template <typename Cdf>
double ks_distance(std::vector<double> sample, Cdf cdf) {
    std::sort(sample.begin(), sample.end());
    const double n = static_cast<double>(sample.size());
    double worst = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const double below = cdf(sample[i]);
        worst = std::max({worst, below - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - below});
    }
    return worst;
}

// A perfect sampler exceeds it once in 10,000 times: P(D > d) = 2 exp(-2 n d^2).
inline double ks_limit(std::size_t n) { return std::sqrt(std::log(2e4) / (2 * static_cast<double>(n))); }

inline double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

// Of neighbours.
inline double correlation_of(const std::vector<double>& values) {
    const double mean = mean_of(values);
    double products = 0;
    double squares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        squares += (values[i] - mean) * (values[i] - mean);
        if (i > 0) products += (values[i] - mean) * (values[i - 1] - mean);
    }
    return products / squares;
}

}  // namespace thimble::test
