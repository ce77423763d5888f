// How long it takes from a hand's motion to the light of the frame that shows it, stage by stage, how regularly frames come,
// and when to begin the next one. One of each per window, in its thread.
#pragma once

#include <algorithm>

#include "common/histogram.hpp"
#include "common/time.hpp"
#include "visual_node/display.hpp"

namespace thimble {

class FrameTimes {
  public:
    // `one_clock`: master and slave_sim run on this machine, so that their stamps and this machine's time can be subtracted.
    // Without it, only what happens here is counted.
    explicit FrameTimes(bool one_clock) : one_clock_(one_clock) {}

    // A frame was begun, and its swap returned: it is on its way to the panel.
    void add(const Scene& scene, SessionTime begun, SessionTime swapped) {
        add_empty(begun, swapped);
        if (scene.sample_time == shown_sample_) return;  // nothing new: its light is out already
        shown_sample_ = scene.sample_time;
        arrival_to_frame.add(begun - scene.sample_time);
        const bool replayed = scene.hand_time == SessionTime{};  // the hand did not move now
        if (!one_clock_ || replayed || scene.answer_time == SessionTime{}) return;
        hand_to_slave.add(scene.answer_time - scene.hand_time);
        slave_to_arrival.add(scene.sample_time - scene.answer_time);
        hand_to_swap.add(swapped - scene.hand_time);
    }
    // A frame without a scene.
    void add_empty(SessionTime begun, SessionTime swapped) {
        draw.add(swapped - begun);
        if (last_swap_ != SessionTime{}) interval.add(swapped - last_swap_);
        last_swap_ = swapped;
    }
    bool one_clock() const { return one_clock_; }

    Histogram hand_to_slave;     // handle read to slave_sim's answer
    Histogram slave_to_arrival;  // on the network, to this program
    Histogram arrival_to_frame;  // waiting for a frame
    Histogram draw;              // frame begun to swap returned, of every frame
    Histogram hand_to_swap;      // all of it
    Histogram interval;          // from swap to swap

  private:
    bool one_clock_;
    SessionTime last_swap_{}, shown_sample_{};
};

// When to begin a frame: as late as it still makes the next refresh, because what is drawn late is seen young.
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
    static constexpr int kFirstFrames = 10;  // drivers make themselves ready in them: nothing to learn
    static constexpr int kQuiet = 600;       // frames without a missed refresh, before less time is tried
    static constexpr int kSlack = 50;        // a monitor may be faster than it says by this part
    // Frames that take longer than planned but miss no refresh: without vsync the planned time sets the rate. A
    // monitor that is slower by 0.1 ms per frame stays below this limit.
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
    int quiet_ = 0, first_frames_ = 0;
};

}  // namespace thimble
