#include "bench/peers/peer_tissue.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace thimble {

namespace {

// As in ExactTissue: more than this in one step is chatter, and the step goes straight to its end.
constexpr unsigned kMostTransitions = 64;

// A surface a million times too stiff for an explicit rule would be stepped for hours.
constexpr std::uint64_t kMostEvaluations = 200'000;

}  // namespace

void PeerTissue::check_effort() const {
    if (evaluations_ <= kMostEvaluations) return;
    throw Error(ExitCode::kRunFailed,
                "more than {} evaluations in one step: the tissue is too stiff for this method",
                kMostEvaluations);
}

void PeerTissue::restart() {
    t_s_ = 0;
    fresh_ = true;
}

void PeerTissue::move(double duration_s, double needle_end_m, Transitions& transitions) {
    step_start_s_ = leg_start_s_ = t_s_;
    leg_needle_m_ = needle_m_;
    evaluations_ = 0;
    search_ = true;
    const double end_s = t_s_ + duration_s;
    // A surface that came to rest was put there by TissueSolver.
    if (surface_m_ != integrated_.position_m || velocity_surface_m_per_s_ != integrated_.velocity_m_per_s) {
        fresh_ = true;
    }
    if (phase_ == TissuePhase::kPenetrated) {
        const double drive_N = parameters_.drag_Ns_per_m * velocity_needle_m_per_s_;
        if (!fresh_ && drive_N != drive_N_) {
            drive_N_ = drive_N;
            drive_changed();
        }
    }
    unsigned count = 0;
    while (phase_ == TissuePhase::kContact ? contact_leg(needle_end_m, end_s, transitions)
                                           : moving_leg(end_s, transitions)) {
        if (++count == kMostTransitions) search_ = false;
    }
    t_s_ = end_s;
}

void PeerTissue::enter(TissuePhase phase, double t_s, Transitions& transitions) {
    phase_ = phase;
    leg_needle_m_ += velocity_needle_m_per_s_ * (t_s - leg_start_s_);
    leg_start_s_ = t_s;
    surface_m_ = leg_needle_m_;
    fresh_ = true;
    transitions.push(t_s - step_start_s_, to_string(phase));
}

// True if a transition ended the leg.
bool PeerTissue::contact_leg(double needle_end_m, double end_s, Transitions& transitions) {
    const double v = velocity_needle_m_per_s_;
    const double limit_N = parameters_.puncture_force_N;
    const double first_N = contact_force_N(leg_needle_m_, v);
    const double last_N = contact_force_N(needle_end_m, v);
    velocity_surface_m_per_s_ = v;
    const bool pierces = first_N > limit_N || (first_N >= 0 && last_N > limit_N);
    const bool parts = !pierces && (first_N < 0 || last_N < 0);
    if (!search_ || (!pierces && !parts)) {
        surface_m_ = needle_end_m;
        integrated_ = {surface_m_, v};
        return false;
    }
    const double guard_N = pierces ? limit_N : 0;
    const bool at_once = pierces ? first_N > limit_N : first_N < 0;
    const double after_s = at_once ? 0 : (guard_N - first_N) / (parameters_.stiffness_N_per_m * v);
    enter(pierces ? TissuePhase::kPenetrated : TissuePhase::kFree, std::min(end_s, leg_start_s_ + after_s),
          transitions);
    return true;
}

// Another mode: side, damping, drive, and the integrator with them.
void PeerTissue::prepare() {
    const bool penetrated = phase_ == TissuePhase::kPenetrated;
    side_ = penetrated ? -1 : 1;
    damping_Ns_per_m_ = parameters_.damping_Ns_per_m + (penetrated ? parameters_.drag_Ns_per_m : 0);
    drive_N_ = penetrated ? parameters_.drag_Ns_per_m * velocity_needle_m_per_s_ : 0;
    start(leg_start_s_, {surface_m_, velocity_surface_m_per_s_});
    fresh_ = false;
}

// True if a transition ended the leg.
bool PeerTissue::moving_leg(double end_s, Transitions& transitions) {
    if (leg_start_s_ >= end_s) return false;
    if (fresh_) prepare();
    const TissuePhase next = phase_ == TissuePhase::kPenetrated ? TissuePhase::kFree : TissuePhase::kContact;
    const bool rising = side_ * (velocity_needle_m_per_s_ - velocity_surface_m_per_s_) > 0;
    if (search_ && rising && gap_m(leg_start_s_, surface_m_) >= 0) {
        enter(next, leg_start_s_, transitions);
        return true;
    }
    Arrival arrival{true, leg_start_s_, {}};
    do {
        arrival = integrate(arrival.t_s, end_s);
        integrated_ = arrival.surface;
        surface_m_ = integrated_.position_m;
        velocity_surface_m_per_s_ = integrated_.velocity_m_per_s;
    } while (arrival.crossed && !search_);
    if (!arrival.crossed) return false;
    enter(next, arrival.t_s, transitions);
    return true;
}

}  // namespace thimble
