// A robust measure of lateness on a machine that stalls: the median over short windows of each window's 50 % and 99
// %. Maxima and raw 99.9 % depend on the host.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace thimble {

struct WindowErrors {
    double w50_us = 0, w99_us = 0;
    double stalled = 0;  // share of windows that hold an error above 1 ms
};

// 0 of none
inline double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

class ErrorWindows {
  public:
    // The errors of one window, a quarter of a second, in microseconds. Less than 20 are not judged.
    void add(std::vector<double> errors_us) {
        if (errors_us.size() < 20) return;
        std::sort(errors_us.begin(), errors_us.end());
        w50_us_.push_back(errors_us[(errors_us.size() - 1) / 2]);
        w99_us_.push_back(errors_us[(errors_us.size() - 1) * 99 / 100]);
        if (errors_us.back() > 1000) ++stalled_;
    }

    WindowErrors errors() const {
        const double windows = static_cast<double>(std::max<std::size_t>(1, w50_us_.size()));
        return {median_of(w50_us_), median_of(w99_us_), static_cast<double>(stalled_) / windows};
    }

  private:
    std::vector<double> w50_us_, w99_us_;
    std::size_t stalled_ = 0;
};

}  // namespace thimble
