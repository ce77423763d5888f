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

  private:
    std::vector<double> deviates_;
};

}  // namespace thimble
