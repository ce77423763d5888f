#include "bench/network/window_errors.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr double kStall_us = 1000;
constexpr std::size_t kFewest = 20;

}  // namespace

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void ErrorWindows::add(std::vector<double> errors_us) {
    if (errors_us.size() < kFewest) return;
    std::sort(errors_us.begin(), errors_us.end());
    w50_us_.push_back(errors_us[(errors_us.size() - 1) / 2]);
    w99_us_.push_back(errors_us[(errors_us.size() - 1) * 99 / 100]);
    if (errors_us.back() > kStall_us) ++stalled_;
}

WindowErrors ErrorWindows::errors() const {
    const double windows = static_cast<double>(std::max<std::size_t>(1, w50_us_.size()));
    return {median_of(w50_us_), median_of(w99_us_), static_cast<double>(stalled_) / windows};
}

}  // namespace thimble
