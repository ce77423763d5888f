// How long it takes from a hand's motion to the light of the frame that shows it, stage by stage, and how regularly frames
// come. One per window, in its thread.
#pragma once

#include "common/histogram.hpp"
#include "visual_node/display.hpp"

namespace thimble {

class FrameTimes {
  public:
    // `one_clock`: master and slave_sim run on this machine, so that their stamps and this machine's time can be subtracted.
    // Without it, only what happens here is counted.
    explicit FrameTimes(bool one_clock) : one_clock_(one_clock) {}

    // A frame was begun, and its swap returned: it is on its way to the panel.
    void add(const Scene& scene, SessionTime begun, SessionTime swapped) {
        draw.add(swapped - begun);
        if (last_swap_ != SessionTime{}) interval.add(swapped - last_swap_);
        last_swap_ = swapped;
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

}  // namespace thimble
