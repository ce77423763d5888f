// When to begin a frame: as late as it still makes the next refresh, because what is drawn late is seen young.
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace thimble {

class FramePace {
  public:
    explicit FramePace(double refresh_Hz) : period_(from_seconds(1 / refresh_Hz)) {}

    // When to begin the next frame, after one that was begun and whose swap returned then. With vsync a swap returns at a
    // refresh; without, nothing waits and the pace is this class's own.
    SessionTime next(SessionTime begun, SessionTime swapped) {
        learn(begun, swapped);
        last_swap_ = swapped;
        const SessionTime late_enough = swapped + period_ - budget_;
        return std::max(late_enough, begun + period_ - period_ / kSlack);
    }
    Duration budget() const { return budget_; }

  private:
    static constexpr Duration kLeast = std::chrono::milliseconds{4};
    static constexpr int kFirstFrames =
        10;                             // slow ones, in which drivers make themselves ready: nothing to learn
    static constexpr int kQuiet = 600;  // frames without a missed refresh, before less time is tried
    static constexpr int kSlack = 50;   // a monitor may be faster than it says by this part
    // Frames that take longer than they are given, and miss nothing: there is no refresh, and the time they are given is
    // what keeps the rate. A monitor slower than it says by 0.1 ms a frame does not look like that yet.
    static constexpr Duration kOver = std::chrono::microseconds{100};
    static constexpr int kOverPart = 8;

    void learn(SessionTime begun, SessionTime swapped) {
        if (first_frames_ < kFirstFrames) {
            ++first_frames_;
            return;
        }
        const bool missed = last_swap_ != SessionTime{} && swapped - last_swap_ > period_ + period_ / 2;
        if (missed || swapped - begun > period_) {
            budget_ = std::min(budget_ * 2, period_);
            quiet_ = 0;
            return;
        }
        const Duration over = swapped - begun - budget_;
        if (over > kOver) budget_ = std::min(budget_ + over / kOverPart, period_);
        if (++quiet_ == kQuiet) {
            budget_ = std::max(budget_ - budget_ / 8, std::min(kLeast, period_));
            quiet_ = 0;
        }
    }

    Duration period_;
    Duration budget_ = kLeast;
    SessionTime last_swap_{};
    int quiet_ = 0;
    int first_frames_ = 0;
};

}  // namespace thimble
