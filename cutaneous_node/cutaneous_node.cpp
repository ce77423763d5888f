#include "cutaneous_node/cutaneous_node.hpp"

#include <cassert>
#include <cmath>

#include "common/control/control_settings.hpp"

namespace thimble {

CutaneousNode::CutaneousNode(const CutaneousSettings& settings, FingertipActuator& actuator)
    : settings_(settings), actuator_(actuator) {
    assert(settings.percept_period > Duration::zero());
}

void CutaneousNode::start_trial(SessionTime now, const SessionControl& control, SessionTime first_force) {
    modality_ = control.modality;
    actuator_.use_hand(now, modality_ == Modality::kCCF ? Hand::kOther : Hand::kActing);
    next_percept_ = presses() ? now : kNever;
    last_feedback_ = first_force;
    age_.begin(now, from_seconds(control.network_delay_s));
    release(now);
}

void CutaneousNode::end_trial(SessionTime now) {
    next_percept_ = kNever;
    release(now);
}

void CutaneousNode::begin_tick(SessionTime now, Duration since_last_tick, bool resting) {
    stood_still_ = since_last_tick > settings_.stale.after;
    resting_ = resting;
    if (stood_still_ || resting_) let_go(now);
}

void CutaneousNode::on_feedback(SessionTime now, SessionTime made, const ForceFeedback& feedback) {
    age_.take_from_elsewhere(now, made);
    if (stood_still_ || age_.late(now) >= settings_.stale.after) return;
    last_feedback_ = now;
    if (!active() || resting_) return;
    if (feedback.needle_held) return let_go(now);
    double force_N = feedback.force_total_N;
    if (modality_ == Modality::kHF) force_N = ScaledForce{settings_.hand_share}.skin_N(force_N);
    Finger finger = Finger::kNone;
    if (force_N < 0) finger = Finger::kIndex;
    if (force_N > 0) finger = Finger::kThumb;
    finger_ = finger;
    force_N_ = std::abs(force_N);
    actuator_.command(now, finger_, force_N_);
    released_ = false;
}

std::optional<Percept> CutaneousNode::percept(SessionTime now) {
    if (now < next_percept_) return std::nullopt;
    // Keeps to the grid of the trial's start; a late call skips what was missed.
    next_percept_ += settings_.percept_period * ((now - next_percept_) / settings_.percept_period + 1);
    fade(now);
    const FingertipForce felt = actuator_.output(now);
    Percept percept;
    percept.finger = felt.finger;
    percept.force_N = felt.force_N;
    percept.sample_age_s = to_seconds(now - felt.sample_time);
    return percept;
}

// Fades the force after the feedback has stopped.
void CutaneousNode::fade(SessionTime now) {
    const Duration silence = now - last_feedback_;
    if (released_ || !settings_.stale.stale(silence)) return;
    const double share = settings_.stale.share(silence);
    if (share <= 0) return release(now);
    if (share < 1) actuator_.command(now, finger_, share * force_N_);
}

void CutaneousNode::release(SessionTime now) {
    actuator_.release(now);
    released_ = true;
}

}  // namespace thimble
