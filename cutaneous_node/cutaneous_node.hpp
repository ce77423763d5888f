// Sensory subtraction: the force that resists the needle, pressed on a finger instead of given to the hand.
// Pushing in (force towards -z) is felt on the index finger, pulling out (towards +z) on the thumb. In CF the
// device is worn on the hand that holds the handle, in CCF on the other one; in HF and VF it stays slack. In HF with a share
// of the force for the hand (ScaledForce) the rest is pressed on the acting hand.
#pragma once

#include <optional>

#include "common/force_age.hpp"
#include "common/messages.hpp"
#include "common/time.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

class CutaneousNode {
  public:
    // `actuator` must outlive the node.
    CutaneousNode(const CutaneousSettings& settings, FingertipActuator& actuator);

    // first_force: when the first force is due.
    void start_trial(SessionTime now, const SessionControl& control, SessionTime first_force);
    void end_trial(SessionTime now);
    // The network delay has changed; there and back.
    void network_changed(Duration network_delay) { age_.allow(network_delay); }
    // Before anything else in a tick. Messages that have waited for a long pause say nothing about now. `resting`: no force in
    // this tick, whatever comes. In both cases the fingers are slack until the next feedback.
    void begin_tick(SessionTime now, Duration since_last_tick, bool resting);
    // Feedback of this trial, in order (the caller's sequence tracking sees to both). `made`: on the clock of its sender. One that
    // is late counts as if it had not come.
    void on_feedback(SessionTime now, SessionTime made, const ForceFeedback& feedback);

    // The percept of the skin, once per period while active; none before next_percept(). Also releases the fingers
    // when the feedback has stopped.
    std::optional<Percept> percept(SessionTime now);
    // kNever unless active.
    SessionTime next_percept() const { return next_percept_; }

    // A trial runs in which the fingers are pressed.
    bool active() const { return next_percept_ != kNever; }
    // The newest trial presses the fingers.
    bool presses() const { return settings_.presses(modality_); }
    // Without news: silent, or with forces that are too late.
    bool stale(SessionTime now) const { return stood_still_ || now - last_feedback_ > settings_.stale.after; }

  private:
    void let_go(SessionTime now) {
        if (!released_) release(now);
    }
    void fade(SessionTime now);
    void release(SessionTime now);

    CutaneousSettings settings_;
    FingertipActuator& actuator_;
    SessionTime next_percept_ = kNever;
    SessionTime last_feedback_{};  // that was not late
    ForceAge age_;                 // of the newest force, beside the youngest of the trial
    Modality modality_ = Modality::kVF;
    bool released_ = true;
    bool stood_still_ = false, resting_ = false;
    Finger finger_ = Finger::kNone;  // of the newest command
    double force_N_ = 0;
};

}  // namespace thimble
