#include "bench/reference_tissue.hpp"

#include "common/error.hpp"

namespace thimble {

namespace {

ReferenceLaw law(const ReferenceNumber& mass, const ReferenceNumber& damping,
                 const ReferenceNumber& stiffness) {
    const ReferenceNumber stiffness_per_s2 = stiffness / mass;
    return {damping / mass, stiffness_per_s2, sqrt(stiffness_per_s2)};
}

}  // namespace

ReferenceTissue::ReferenceTissue(const ReferenceParameters& p)
    : parameters_(p),
      laws_{law(p.mass_kg, p.damping_Ns_per_m, p.stiffness_N_per_m),
            law(p.mass_kg, p.damping_Ns_per_m + p.drag_Ns_per_m, p.stiffness_N_per_m)} {
    reset(p.rest_position_m);
}

void ReferenceTissue::reset(const ReferenceNumber& position_needle_m) {
    needle_m_ = position_needle_m - parameters_.rest_position_m;
    phase_ = needle_m_ > 0 ? TissuePhase::kPenetrated : TissuePhase::kFree;
    surface_ = {0, 0, 0};
    velocity_needle_m_per_s_ = 0;
    t_s_ = 0;
    events_.clear();
}

void ReferenceTissue::step(const ReferenceNumber& duration_s, const ReferenceNumber& position_needle_m) {
    constexpr unsigned kMostTransitions = 100'000;
    const ReferenceNumber end_m = position_needle_m - parameters_.rest_position_m;
    const ReferenceNumber end_s = t_s_ + duration_s;
    velocity_needle_m_per_s_ = (end_m - needle_m_) / duration_s;
    remaining_s_ = duration_s;
    whole_step_ = true;
    // The drive changes with the velocity of the needle, and the acceleration with it.
    const bool penetrated = phase_ == TissuePhase::kPenetrated;
    const ReferenceLaw& surface_law = laws_[penetrated];
    surface_.acceleration_m_per_s2 = -surface_law.damping_per_s * surface_.velocity_m_per_s -
                                     surface_law.stiffness_per_s2 * surface_.position_m;
    if (penetrated) {
        surface_.acceleration_m_per_s2 +=
            parameters_.drag_Ns_per_m * velocity_needle_m_per_s_ / parameters_.mass_kg;
    }
    for (unsigned count = 0; phase_ == TissuePhase::kContact ? contact_leg() : moving_leg(); ++count) {
        if (count == kMostTransitions) {
            throw Error(ExitCode::kRunFailed,
                        "the reference solution goes through 100 000 transitions in one step, near t = " +
                            end_s.str(10) + " s: check the problem");
        }
    }
    needle_m_ = end_m;
    if (phase_ == TissuePhase::kContact) surface_.position_m = end_m;
    t_s_ = end_s;
}

ReferenceNumber ReferenceTissue::contact_force_N(const ReferenceNumber& needle_m) const {
    return parameters_.stiffness_N_per_m * needle_m + parameters_.damping_Ns_per_m * velocity_needle_m_per_s_;
}

void ReferenceTissue::enter(TissuePhase phase, const ReferenceNumber& after_s) {
    phase_ = phase;
    t_s_ += after_s;
    remaining_s_ -= after_s;
    whole_step_ = false;
    needle_m_ += velocity_needle_m_per_s_ * after_s;
    surface_.position_m = needle_m_;  // the gap is zero at every transition
    events_.push_back({t_s_, phase});
}

// Needle and surface are of one velocity here, so that the drag is zero and the surface has only its own force,
// which at a guard is known exactly.
void ReferenceTissue::part_from_needle(TissuePhase phase, const ReferenceNumber& force_N) {
    const ReferenceNumber change_N = force_N - contact_force_N(needle_m_);
    const bool slides = change_N != 0;
    enter(phase, slides
                     ? ReferenceNumber(change_N / (parameters_.stiffness_N_per_m * velocity_needle_m_per_s_))
                     : ReferenceNumber(0));
    surface_.acceleration_m_per_s2 = -force_N / parameters_.mass_kg;
}

bool ReferenceTissue::contact_leg() {
    const ReferenceNumber limit_N = parameters_.puncture_force_N;
    const ReferenceNumber end_m = needle_m_ + velocity_needle_m_per_s_ * remaining_s_;
    const ReferenceNumber first_N = contact_force_N(needle_m_);
    const ReferenceNumber last_N = contact_force_N(end_m);
    surface_.velocity_m_per_s = velocity_needle_m_per_s_;
    if (first_N < 0) {
        part_from_needle(TissuePhase::kFree, first_N);
    } else if (first_N > limit_N) {
        part_from_needle(TissuePhase::kPenetrated, first_N);
    } else if (last_N < 0) {
        part_from_needle(TissuePhase::kFree, 0);
    } else if (last_N > limit_N) {
        part_from_needle(TissuePhase::kPenetrated, limit_N);
    } else {
        return false;
    }
    return true;
}

ReferenceHalving& ReferenceTissue::halving(bool penetrated) {
    auto& list = (whole_step_ ? kept_ : spare_)[penetrated];
    if (list.empty() || list.front().duration_s() != remaining_s_) {
        list.clear();
        list.emplace_back(laws_[penetrated], remaining_s_);
    }
    return list.front();
}

bool ReferenceTissue::moving_leg() {
    if (remaining_s_ <= 0) return false;
    const bool penetrated = phase_ == TissuePhase::kPenetrated;
    const ReferenceGap gap{penetrated ? -1 : 1, needle_m_, velocity_needle_m_per_s_, laws_[penetrated]};
    ReferenceHalving& motion = halving(penetrated);
    const auto crossing = first_crossing(gap, surface_, motion);
    if (!crossing) {
        surface_ = motion.advance(surface_, 0);
        return false;
    }
    surface_ = crossing->motion;
    enter(penetrated ? TissuePhase::kFree : TissuePhase::kContact, crossing->after_s);
    if (penetrated) {
        surface_.acceleration_m_per_s2 = -laws_[0].damping_per_s * surface_.velocity_m_per_s -
                                         laws_[0].stiffness_per_s2 * surface_.position_m;
    }
    return true;
}

ReferenceState ReferenceTissue::state() const {
    const ReferenceNumber rest_m = parameters_.rest_position_m;
    switch (phase_) {
        case TissuePhase::kContact:
            return {phase_, rest_m + needle_m_, velocity_needle_m_per_s_, -contact_force_N(needle_m_)};
        case TissuePhase::kPenetrated:
            return {phase_, rest_m + surface_.position_m, surface_.velocity_m_per_s,
                    -parameters_.drag_Ns_per_m * (velocity_needle_m_per_s_ - surface_.velocity_m_per_s)};
        case TissuePhase::kFree:
            break;
    }
    return {phase_, rest_m + surface_.position_m, surface_.velocity_m_per_s, 0};
}

}  // namespace thimble
