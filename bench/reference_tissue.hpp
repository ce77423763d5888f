// The automaton of slave_sim/tissue_solver.hpp solved to 40 digits and more, by other means than any solver
// that is judged by it: 100-digit numbers, Taylor series of the matrix exponential, events isolated by
// halving. Durations and needle positions are taken as exact; between samples the needle moves linearly.
// Some milliseconds per event; nothing here is meant to be fast.
#pragma once

#include <array>
#include <vector>

#include "bench/reference_motion.hpp"
#include "slave_sim/tissue_solver.hpp"

namespace thimble {

struct ReferenceParameters {
    ReferenceParameters() = default;
    explicit ReferenceParameters(const TissueParameters& p)
        : mass_kg(p.mass_kg),
          stiffness_N_per_m(p.stiffness_N_per_m),
          damping_Ns_per_m(p.damping_Ns_per_m),
          drag_Ns_per_m(p.drag_Ns_per_m),
          puncture_force_N(p.puncture_force_N),
          rest_position_m(p.rest_position_m) {}

    ReferenceNumber mass_kg, stiffness_N_per_m, damping_Ns_per_m, drag_Ns_per_m, puncture_force_N,
        rest_position_m;
};

// As TissueState: left limits.
struct ReferenceState {
    TissuePhase phase = TissuePhase::kFree;
    ReferenceNumber position_surface_m;
    ReferenceNumber velocity_surface_m_per_s;
    ReferenceNumber force_N;
};

struct ReferenceEvent {
    ReferenceNumber t_s;  // since the reset
    TissuePhase phase;    // entered
};

class ReferenceTissue {
  public:
    explicit ReferenceTissue(const ReferenceParameters& parameters);

    void reset(const ReferenceNumber& position_needle_m);
    // duration > 0. Throws Error (run failed) after 100 000 transitions in one step.
    void step(const ReferenceNumber& duration_s, const ReferenceNumber& position_needle_m);

    const ReferenceNumber& t_s() const { return t_s_; }
    ReferenceState state() const;
    const std::vector<ReferenceEvent>& events() const { return events_; }

  private:
    // Advance to the next transition or the end of the step; true if it was a transition.
    bool contact_leg();
    bool moving_leg();
    void enter(TissuePhase phase, const ReferenceNumber& after_s);
    void part_from_needle(TissuePhase phase, const ReferenceNumber& force_N);
    ReferenceNumber contact_force_N(const ReferenceNumber& needle_m) const;
    ReferenceHalving& halving(bool penetrated);

    ReferenceParameters parameters_;
    std::array<ReferenceLaw, 2> laws_;                    // of the surface alone, and with the needle in it
    std::array<std::vector<ReferenceHalving>, 2> kept_;   // for the duration of a whole step
    std::array<std::vector<ReferenceHalving>, 2> spare_;  // for what an event left of one
    std::vector<ReferenceEvent> events_;
    TissuePhase phase_ = TissuePhase::kFree;
    ReferenceNumber t_s_;
    ReferenceNumber remaining_s_;  // of the step
    bool whole_step_ = true;
    ReferenceNumber needle_m_;  // relative to the surface's rest position, as is `surface_`
    ReferenceNumber velocity_needle_m_per_s_;
    ReferenceMotion surface_;
};

}  // namespace thimble
