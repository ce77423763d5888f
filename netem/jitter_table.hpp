// The shape of a delay distribution as it was measured: standardised deviates in rising order, as iproute2's
// .dist files hold them (read by jitter_table_file.hpp).
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

namespace thimble {

class JitterTable {
  public:
    // At least two, finite, sorted; mean 0 and standard deviation 1 if delay and spread are to be what was asked.
    explicit JitterTable(std::vector<double> deviates) : deviates_(std::move(deviates)) {
        assert(deviates_.size() >= 2 && std::is_sorted(deviates_.begin(), deviates_.end()));
        assert(std::isfinite(deviates_.front()) && std::isfinite(deviates_.back()));
    }

    // The deviate below which a share u of all lies, u in [0, 1]. Deviate i of n stands at (i + 1/2) / n; between
    // them straight lines, beyond the outermost their values.
    double quantile(double u) const {
        const double position = u * static_cast<double>(deviates_.size()) - 0.5;
        if (position <= 0) return deviates_.front();
        const double last = static_cast<double>(deviates_.size() - 1);
        if (position >= last) return deviates_.back();
        const auto below = static_cast<std::size_t>(position);
        const double share = position - static_cast<double>(below);
        return deviates_[below] + share * (deviates_[below + 1] - deviates_[below]);
    }

    const std::vector<double>& deviates() const { return deviates_; }
    // Of quantile(u) with u uniform in [0, 1], exact.
    // Half a cell of constant value at each end, straight lines between.
    double mean() const {
        double sum = (deviates_.front() + deviates_.back()) / 2;
        for (std::size_t i = 1; i < deviates_.size(); ++i) sum += (deviates_[i - 1] + deviates_[i]) / 2;
        return sum / static_cast<double>(deviates_.size());
    }

    // The mean square over a straight line from a to b is (a^2 + a b + b^2) / 3.
    double standard_deviation() const {
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

  private:
    std::vector<double> deviates_;
};

}  // namespace thimble
