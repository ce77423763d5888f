#include "common/velocity/windowed_velocity.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {

WindowedVelocity::WindowedVelocity(Duration window) : window_(window) { assert(window > Duration::zero()); }

double WindowedVelocity::advance(Duration step, double position_m) {
    samples_.push(step, position_m);
    // Summed anew each time and relative to the newest sample: a running sum would drift.
    double sum_m_ns = 0;
    Duration left = window_;
    for (std::size_t age = 0; age < samples_.size() && left > Duration::zero(); ++age) {
        const WindowSample& sample = samples_[age];
        const bool oldest = age + 1 == samples_.size();
        const Duration held = oldest ? left : std::min(sample.step, left);
        sum_m_ns += (sample.position_m - position_m) * static_cast<double>(held.count());
        left -= held;
    }
    return position_m + sum_m_ns / static_cast<double>(window_.count());
}

}  // namespace thimble
