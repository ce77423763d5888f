// Sensory subtraction: the force that resists the needle, pressed on a finger instead of given to the hand.
// Pushing in (force towards -z) is felt on the index finger, pulling out (towards +z) on the thumb. In CF the
// device is worn on the hand that holds the handle, in CCF on the other one; in HF and VF it stays slack. In HF with a share
// of the force for the hand (scaled_force.hpp) the rest is pressed on the acting hand.
#pragma once

#include <optional>

#include "common/messages.hpp"
#include "common/time.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

class CutaneousNode {
  public:
    // `actuator` must outlive the node.
    CutaneousNode(const CutaneousSettings& settings, FingertipActuator& actuator);

    void start_trial(SessionTime now, const SessionControl& control);
    void end_trial(SessionTime now);
    // Feedback of this trial, in order (the caller's sequence tracking sees to both).
    void on_feedback(SessionTime now, const ForceFeedback& feedback);

    // The fingers are slack until the next feedback.
    void let_go(SessionTime now) {
        if (!released_) release(now);
    }

    // The percept of the skin, once per period while active; none before next_percept(). Also releases the fingers when the feedback has stopped.
    std::optional<Percept> percept(SessionTime now);
    // kNever unless active.
    SessionTime next_percept() const { return next_percept_; }

    // A trial runs in which the fingers are pressed.
    // A trial of this modality presses the fingers.
    bool presses(Modality modality) const {
        return modality == Modality::kCF || modality == Modality::kCCF ||
               (modality == Modality::kHF && settings_.hand_share < 1);
    }
    bool active() const { return next_percept_ != kNever; }
    bool acting_hand() const { return active() && modality_ != Modality::kCCF; }
    bool contralateral() const { return active() && modality_ == Modality::kCCF; }

  private:
    void fade(SessionTime now);
    void release(SessionTime now);

    CutaneousSettings settings_;
    FingertipActuator& actuator_;
    SessionTime next_percept_ = kNever;
    SessionTime last_feedback_{};
    Modality modality_ = Modality::kHF;
    bool released_ = true;
    Finger finger_ = Finger::kNone;  // of the newest command
    double force_N_ = 0;
};

}  // namespace thimble
