#include "netem/jitter_table.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace thimble {

JitterTable::JitterTable(std::vector<double> deviates) : deviates_(std::move(deviates)) {
    assert(deviates_.size() >= 2 && std::is_sorted(deviates_.begin(), deviates_.end()));
    assert(std::isfinite(deviates_.front()) && std::isfinite(deviates_.back()));
}

double JitterTable::quantile(double u) const {
    const double position = u * static_cast<double>(deviates_.size()) - 0.5;
    if (position <= 0) return deviates_.front();
    const double last = static_cast<double>(deviates_.size() - 1);
    if (position >= last) return deviates_.back();
    const auto below = static_cast<std::size_t>(position);
    const double share = position - static_cast<double>(below);
    return deviates_[below] + share * (deviates_[below + 1] - deviates_[below]);
}

// Half a cell of constant value at each end, straight lines between.
double JitterTable::mean() const {
    double sum = (deviates_.front() + deviates_.back()) / 2;
    for (std::size_t i = 1; i < deviates_.size(); ++i) sum += (deviates_[i - 1] + deviates_[i]) / 2;
    return sum / static_cast<double>(deviates_.size());
}

// The mean square over a straight line from a to b is (a^2 + a b + b^2) / 3.
double JitterTable::standard_deviation() const {
    const double middle = mean();
    const double first = deviates_.front() - middle;
    const double last = deviates_.back() - middle;
    double sum = (first * first + last * last) / 2;
    for (std::size_t i = 1; i < deviates_.size(); ++i) {
        const double a = deviates_[i - 1] - middle;
        const double b = deviates_[i] - middle;
        sum += (a * a + a * b + b * b) / 3;
    }
    return std::sqrt(sum / static_cast<double>(deviates_.size()));
}

}  // namespace thimble
