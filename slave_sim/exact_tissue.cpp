#include "slave_sim/exact_tissue.hpp"

#include <cmath>

#include "slave_sim/crossing.hpp"

namespace thimble {

namespace {

// A released or pierced surface moves away from the needle, so without rounding phases cannot follow one
// another without end. This many transitions within this fraction of a step are taken for chatter, and the
// step goes straight to its end.
constexpr unsigned kMostTransitions = 64;
constexpr double kProgress = 1e-6;
constexpr std::string_view kUnresolved = "unresolved";  // the rest of the step was not searched

}  // namespace

// The rest of a step after the transitions found so far.
struct ExactTissue::Leg {
    double duration_s;    // of the step
    double offset_s;      // of its start within the step
    double remaining_s;   // to the end of the step
    double needle_end_m;  // at the end of the step
    bool search;          // look for further transitions
    Transitions* transitions;
};

ExactTissue::ExactTissue(const TissueParameters& parameters)
    : TissueSolver(parameters),
      laws_{SecondOrder(parameters.mass_kg, parameters.damping_Ns_per_m, parameters.stiffness_N_per_m),
            SecondOrder(parameters.mass_kg, parameters.damping_Ns_per_m + parameters.drag_Ns_per_m,
                        parameters.stiffness_N_per_m)} {}

void ExactTissue::move(double duration_s, double needle_end_m, Transitions& transitions) {
    Leg leg{duration_s, 0, duration_s, needle_end_m, true, &transitions};
    unsigned count = 0;
    double since_s = 0;
    evaluations_before_ = evaluations_;
    while (phase_ == TissuePhase::kContact ? contact_leg(leg) : moving_leg(leg)) {
        if (leg.offset_s - since_s > kProgress * duration_s) {
            since_s = leg.offset_s;
            count = 0;
        }
        if (++count == kMostTransitions && leg.search) give_up(leg);
    }
    if (!leg.search) agree_with_guards(leg);
}

// After a step that was not searched: a needle beyond a free surface is taken to have pierced it, one outside a
// pierced surface to have left it, and a contact ends that is pulled or pressed too hard. Nothing moves.
void ExactTissue::agree_with_guards(const Leg& leg) {
    const auto become = [&](TissuePhase phase) {
        phase_ = phase;
        leg.transitions->push(leg.duration_s, to_string(phase));
    };
    const double gap_m = leg.needle_end_m - surface_m_;
    if (phase_ == TissuePhase::kFree && gap_m > 0) {
        become(TissuePhase::kContact);
        become(TissuePhase::kPenetrated);
    } else if (phase_ == TissuePhase::kPenetrated && gap_m < 0) {
        become(TissuePhase::kFree);
    } else if (phase_ == TissuePhase::kContact) {
        const double force_N = contact_force_N(leg.needle_end_m, velocity_needle_m_per_s_);
        if (force_N < 0) become(TissuePhase::kFree);
        if (force_N > parameters_.puncture_force_N) become(TissuePhase::kPenetrated);
    }
}

void ExactTissue::give_up(Leg& leg) {
    leg.search = false;
    leg.transitions->push(leg.offset_s, kUnresolved);
    ++unresolved_steps_;
}

// Records a transition and puts needle and surface on the instant; the gap is zero there by definition.
void ExactTissue::enter(TissuePhase phase, double after_s, Leg& leg) {
    phase_ = phase;
    needle_m_ = after_s < leg.remaining_s ? needle_m_ + velocity_needle_m_per_s_ * after_s : leg.needle_end_m;
    surface_m_ = needle_m_;
    leg.offset_s = std::fmin(leg.offset_s + after_s, leg.duration_s);  // a sum of many rounds beyond it
    leg.remaining_s -= after_s;
    leg.transitions->push(leg.offset_s, to_string(phase));
}

// The time after which side * (f - limit) is positive, if it is at the end of the leg. The closed root can be early
// by a rounding error. The next phase would then return at once.
double ExactTissue::beyond_s(double limit_N, double side, const Leg& leg) const {
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
bool ExactTissue::contact_leg(Leg& leg) {
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

// False only if the needle is too far away for this leg: cheaper than a sample of the gap at its end. By the
// greatest acceleration; and, for light tissue, by the greatest velocity: |x'(t)| <= |x'(0)| + |x''(0)| M / B,
// since S, the response of x' to x''(0), obeys S' + (B / M) S <= 1.
bool ExactTissue::may_cross(const Leg& leg, const SecondOrder& law, double acceleration) const {
    const double v = velocity_surface_m_per_s_;
    const double t_s = leg.remaining_s;
    const double gap_m = std::abs(needle_m_ - surface_m_);
    const double closing_m_per_s = std::abs(velocity_needle_m_per_s_ - v);
    if (gap_m > (closing_m_per_s + 0.5 * law.acceleration_bound(v, acceleration) * t_s) * t_s) return false;
    const double per_s = law.damping_per_s();
    const double room_m = gap_m - std::abs(velocity_needle_m_per_s_) * t_s;
    return (per_s * std::abs(v) + std::abs(acceleration)) * t_s >= per_s * room_m;
}

// When the needle enters (free) or leaves (penetrated) within the leg.
double ExactTissue::crossing(Leg& leg, const SecondOrder& law, const Propagator& p, double acceleration) {
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
    const std::uint64_t spent = evaluations_ - evaluations_before_;
    gap.most_propagators = spent < kMostEvaluations ? kMostEvaluations - spent : 0;
    const double after_s = first_rise(gap, leg.remaining_s);
    evaluations_ += gap.propagators;
    if (after_s == kUnsearched) {
        give_up(leg);
        return kNoCrossing;
    }
    if (after_s < leg.remaining_s * (1 - 1e-15)) return after_s;
    // Where the line ends is known better than where its slope leads: a needle that ends on the surface to
    // the last bit has not passed it. (Summed from the left, not by moved_m(): that rounds otherwise.)
    const double surface_end_m = surface_m_ + p.position_per_velocity_s * velocity_surface_m_per_s_ +
                                 p.position_per_acceleration_s2 * acceleration;
    return gap.side * (leg.needle_end_m - surface_end_m) > 0 ? after_s : kNoCrossing;
}

// True if a transition ended the leg. Free or penetrated: the surface moves by its own law.
bool ExactTissue::moving_leg(Leg& leg) {
    const bool penetrated = phase_ == TissuePhase::kPenetrated;
    const SecondOrder& law = laws_[penetrated];
    Propagator& cached = cached_[penetrated];
    if (cached.duration_s != leg.remaining_s) cached = law.propagator(leg.remaining_s);
    const double drive_N = penetrated ? parameters_.drag_Ns_per_m * velocity_needle_m_per_s_ : 0;
    const double acceleration = law.acceleration(drive_N, surface_m_, velocity_surface_m_per_s_);

    ++evaluations_;
    const double v = velocity_surface_m_per_s_;
    if (leg.search && may_cross(leg, law, acceleration)) {
        const double after_s = crossing(leg, law, cached, acceleration);
        if (after_s != kNoCrossing) {
            velocity_surface_m_per_s_ = law.propagator(after_s).velocity_after_m_per_s(v, acceleration);
            enter(penetrated ? TissuePhase::kFree : TissuePhase::kContact, after_s, leg);
            return true;
        }
    }
    velocity_surface_m_per_s_ = cached.velocity_after_m_per_s(v, acceleration);
    surface_m_ += cached.moved_m(v, acceleration);
    return false;
}

}  // namespace thimble
