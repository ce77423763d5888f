// The newest samples of a position, each with its distance in time from the one before. Fixed room: a sample
// that finds the window full pushes out the oldest.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>

#include "common/time.hpp"

namespace thimble {

struct WindowSample {
    Duration step{};  // since the sample before; > 0 except for the very first
    double position_m = 0;
};

class SampleWindow {
  public:
    static constexpr std::size_t kCapacity = 256;  // a power of two, so that wrapping is cheap

    // Empty but for one sample.
    void reset(double position_m) {
        newest_ = 0;
        size_ = 1;
        samples_[0] = {Duration{0}, position_m};
    }

    void push(Duration step, double position_m) {
        newest_ = (newest_ + 1) % kCapacity;
        samples_[newest_] = {step, position_m};
        if (size_ < kCapacity) ++size_;
    }

    std::size_t size() const { return size_; }

    // 0 is the newest; age < size().
    const WindowSample& operator[](std::size_t age) const {
        assert(age < size_);
        return samples_[(newest_ + kCapacity - age) % kCapacity];
    }

  private:
    std::array<WindowSample, kCapacity> samples_{};
    std::size_t newest_ = 0;
    std::size_t size_ = 1;
};

}  // namespace thimble
