#include "analysis/statistics/adjustment.hpp"

#include <algorithm>
#include <numeric>

#include "analysis/statistics/named_values.hpp"

namespace thimble {
namespace {

void require_probabilities(const std::vector<double>& p) {
    for (const double value : p) {
        if (value >= 0 && value <= 1) continue;
        refuse("adjustment of P values", "P = " + std::to_string(value) + " is not in [0, 1]");
    }
}

}  // namespace

std::vector<double> bonferroni(const std::vector<double>& p) {
    require_probabilities(p);
    std::vector<double> adjusted;
    adjusted.reserve(p.size());
    for (const double value : p) adjusted.push_back(std::min(1.0, static_cast<double>(p.size()) * value));
    return adjusted;
}

std::vector<double> holm(const std::vector<double>& p) {
    require_probabilities(p);
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
    std::vector<double> adjusted(p.size());
    double largest = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        largest = std::max(largest, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
        adjusted[order[i]] = largest;
    }
    return adjusted;
}

}  // namespace thimble
