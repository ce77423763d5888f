#include "slave_sim/tissue.hpp"

#include <cassert>

#include "slave_sim/crossing.hpp"

namespace thimble {

namespace {

// A released or pierced surface moves away from the needle, so without rounding phases cannot follow one
// another without end. This many transitions within this fraction of a step are taken for chatter, and the
// step goes straight to its end.
constexpr unsigned kMostTransitions = 64;
constexpr double kProgress = 1e-6;

}  // namespace

// What is left of a step after the transitions found so far.
struct Tissue::Leg {
    double offset_s;      // of its start within the step
    double remaining_s;   // to the end of the step
    double needle_end_m;  // at the end of the step
    bool search;          // look for further transitions
    TissueEvents* events;
};

Tissue::Tissue(const TissueParameters& parameters)
    : parameters_(parameters),
      laws_{SecondOrder(parameters.mass_kg, parameters.damping_Ns_per_m, parameters.stiffness_N_per_m),
            SecondOrder(parameters.mass_kg, parameters.damping_Ns_per_m + parameters.drag_Ns_per_m,
                        parameters.stiffness_N_per_m)} {
    assert(parameters.drag_Ns_per_m >= 0 && parameters.puncture_force_N > 0);
}

void Tissue::reset(double position_needle_m) {
    needle_m_ = position_needle_m - parameters_.rest_position_m;
    phase_ = needle_m_ > 0 ? TissuePhase::kPenetrated : TissuePhase::kFree;
    surface_m_ = 0;
    velocity_needle_m_per_s_ = 0;
    velocity_surface_m_per_s_ = 0;
}

TissueState Tissue::state() const {
    const double rest_m = parameters_.rest_position_m;
    const double v_needle = velocity_needle_m_per_s_;
    const double v_surface = velocity_surface_m_per_s_;
    switch (phase_) {
        case TissuePhase::kContact:
            return {phase_, rest_m + needle_m_, v_needle, -contact_force_N(needle_m_, v_needle)};
        case TissuePhase::kPenetrated:
            return {phase_, rest_m + surface_m_, v_surface,
                    -parameters_.drag_Ns_per_m * (v_needle - v_surface)};
        case TissuePhase::kFree:
            break;
    }
    return {phase_, rest_m + surface_m_, v_surface, 0};
}

void Tissue::step(double duration_s, double position_needle_m, TissueEvents& events) {
    assert(duration_s >= 0);
    if (duration_s == 0) return;
    Leg leg{0, duration_s, position_needle_m - parameters_.rest_position_m, true, &events};
    velocity_needle_m_per_s_ = (leg.needle_end_m - needle_m_) / duration_s;
    unsigned transitions = 0;
    double since_s = 0;
    while (phase_ == TissuePhase::kContact ? contact_leg(leg) : moving_leg(leg)) {
        if (leg.offset_s - since_s > kProgress * duration_s) {
            since_s = leg.offset_s;
            transitions = 0;
        }
        if (++transitions == kMostTransitions) {
            leg.search = false;
            ++unresolved_steps_;
        }
    }
    needle_m_ = leg.needle_end_m;
}

// Records a transition and puts needle and surface on the instant; the gap is zero there by definition.
void Tissue::enter(TissuePhase phase, double after_s, Leg& leg) {
    phase_ = phase;
    needle_m_ = after_s < leg.remaining_s ? needle_m_ + velocity_needle_m_per_s_ * after_s : leg.needle_end_m;
    surface_m_ = needle_m_;
    leg.offset_s += after_s;
    leg.remaining_s -= after_s;
    leg.events->push({leg.offset_s, phase});
}

// When side * (f - limit) has become positive, given that it is at the end of the leg. The closed root can
// lie a rounding error early, where the next phase would still see the guard unmet and come straight back.
double Tissue::beyond_s(double limit_N, double side, const Leg& leg) const {
    const double v = velocity_needle_m_per_s_;
    const double missing_N = limit_N - contact_force_N(needle_m_, v);
    double t_s = missing_N / (parameters_.stiffness_N_per_m * v);
    double nudge_s = leg.remaining_s * 1e-16;
    while (t_s < leg.remaining_s && side * (contact_force_N(needle_m_ + v * t_s, v) - limit_N) <= 0) {
        t_s += nudge_s;
        nudge_s *= 2;
    }
    return t_s < leg.remaining_s ? t_s : leg.remaining_s;
}

// True if a transition ended the leg. The contact force is a line in time.
bool Tissue::contact_leg(Leg& leg) {
    const double v = velocity_needle_m_per_s_;
    const double limit_N = parameters_.puncture_force_N;
    const double first_N = contact_force_N(needle_m_, v);
    const double last_N = contact_force_N(leg.needle_end_m, v);
    velocity_surface_m_per_s_ = v;
    if (!leg.search || (first_N >= 0 && first_N <= limit_N && last_N >= 0 && last_N <= limit_N)) {
        surface_m_ = leg.needle_end_m;
        return false;
    }
    if (first_N < 0) {
        enter(TissuePhase::kFree, 0, leg);
    } else if (first_N > limit_N) {
        enter(TissuePhase::kPenetrated, 0, leg);
    } else if (last_N < 0) {
        enter(TissuePhase::kFree, beyond_s(0, -1, leg), leg);
    } else {
        enter(TissuePhase::kPenetrated, beyond_s(limit_N, 1, leg), leg);
    }
    return true;
}

// When the needle enters (free) or leaves (penetrated) within the leg.
double Tissue::crossing(const Leg& leg, const SecondOrder& law, const Propagator& p,
                        double acceleration) const {
    GapMotion gap;
    gap.side = phase_ == TissuePhase::kFree ? 1 : -1;
    gap.gap_m = needle_m_ - surface_m_;
    gap.velocity_needle_m_per_s = velocity_needle_m_per_s_;
    gap.velocity_surface_m_per_s = velocity_surface_m_per_s_;
    gap.acceleration_surface_m_per_s2 = acceleration;
    gap.law = &law;
    const GapMotion::Sample from{gap.side * gap.gap_m,
                                 gap.side * (velocity_needle_m_per_s_ - velocity_surface_m_per_s_),
                                 law.acceleration_bound(velocity_surface_m_per_s_, acceleration)};
    if (cannot_rise(from, gap.at(p), leg.remaining_s)) return kNoCrossing;
    return first_rise(gap, leg.remaining_s);
}

// True if a transition ended the leg. Free or penetrated: the surface moves by its own law.
bool Tissue::moving_leg(Leg& leg) {
    const bool penetrated = phase_ == TissuePhase::kPenetrated;
    const SecondOrder& law = laws_[penetrated];
    Propagator& cached = cached_[penetrated];
    if (cached.duration_s != leg.remaining_s) cached = law.propagator(leg.remaining_s);
    const double drive_N = penetrated ? parameters_.drag_Ns_per_m * velocity_needle_m_per_s_ : 0;
    const double acceleration = law.acceleration(drive_N, surface_m_, velocity_surface_m_per_s_);

    const double after_s = leg.search ? crossing(leg, law, cached, acceleration) : kNoCrossing;
    const bool crossed = after_s != kNoCrossing;
    const Propagator p = crossed ? law.propagator(after_s) : cached;
    const double v = velocity_surface_m_per_s_;
    velocity_surface_m_per_s_ = p.velocity_per_velocity * v + p.velocity_per_acceleration_s * acceleration;
    if (crossed) {
        enter(penetrated ? TissuePhase::kFree : TissuePhase::kContact, after_s, leg);
    } else {
        surface_m_ += p.position_per_velocity_s * v + p.position_per_acceleration_s2 * acceleration;
    }
    return crossed;
}

}  // namespace thimble
