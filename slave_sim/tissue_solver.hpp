// Needle and one tissue surface in one dimension: the hybrid automaton that every solver steps.
//
// z_n needle tip, z_t surface, x = z_t - rest position; K, B, M stiffness, damping and mass of the tissue, V
// drag of the needle beneath the surface, F_p puncture force.
//
//   phase        motion of the surface                          force on the operator
//   free         M x'' = -K x - B x'                            0
//   contact      z_t = z_n, z_t' = z_n'                         -f,  f = K x + B z_n'
//   penetrated   M x'' = -K x - B x' - V (z_t' - z_n')          -V (z_n' - z_t')
//
//   free -> contact        the gap z_n - z_t reaches 0 while closing (inelastic: z_t' becomes z_n')
//   contact -> penetrated  f > F_p
//   contact -> free        f < 0
//   penetrated -> free     the gap reaches 0 while the needle leaves
#pragma once

#include <functional>
#include <memory>

#include "common/messages.hpp"
#include "slave_sim/element.hpp"

namespace thimble {

struct TissueParameters {
    double mass_kg = 1;              // > 0
    double stiffness_N_per_m = 2;    // >= 0
    double damping_Ns_per_m = 5;     // >= 0
    double drag_Ns_per_m = 0.7;      // >= 0
    double puncture_force_N = 0.1;   // > 0
    double rest_position_m = 0.020;  // of the surface
};

struct TissueState {
    TissuePhase phase = TissuePhase::kFree;
    double position_surface_m = 0;
    double velocity_surface_m_per_s = 0;
    double force_N = 0;  // on the operator
};

class TissueSolver : public Element {
  public:
    // A free surface that will never again move further than this from its rest is put to rest.
    static constexpr double kStillMetres = 1e-15;

    explicit TissueSolver(const TissueParameters& parameters);

    // Surface at rest. A needle that starts beneath it is in the tissue, on or above it free.
    void reset(double position_needle_m) final;
    void step(const NeedleStep& step, Transitions& transitions) final;
    double force_N() const final { return state().force_N; }
    double rests_above_m() const final {
        return phase_ == TissuePhase::kFree && velocity_surface_m_per_s_ == 0 && still()
                   ? parameters_.rest_position_m + surface_m_
                   : -std::numeric_limits<double>::infinity();
    }

    // A step from the current needle position, for callers without a scene or a clock. duration >= 0; zero changes
    // nothing.
    void advance(double duration_s, double position_needle_m, Transitions& transitions);

    TissueState state() const;
    const TissueParameters& parameters() const { return parameters_; }

  protected:
    // Moves the needle from needle_m_ to `needle_end_m` at velocity_needle_m_per_s_, and phase and surface
    // with it. needle_m_ is set to the end afterwards.
    virtual void move(double duration_s, double needle_end_m, Transitions& transitions) = 0;
    // Called after the surface was reset: a solver resets its own state here.
    virtual void restart() {}

    // f of a needle in contact.
    double contact_force_N(double needle_m, double velocity_m_per_s) const {
        return parameters_.stiffness_N_per_m * needle_m + parameters_.damping_Ns_per_m * velocity_m_per_s;
    }
    TissueParameters parameters_;
    TissuePhase phase_ = TissuePhase::kFree;
    // Needle and surface relative to the surface's rest position.
    double needle_m_ = 0;
    double surface_m_ = 0;
    double velocity_needle_m_per_s_ = 0;
    double velocity_surface_m_per_s_ = 0;

  private:
    void settle();
    bool still() const { return surface_m_ == 0 || parameters_.stiffness_N_per_m == 0; }

    double position_needle_m_ = 0;  // as it was given, for advance()
};

// How a scene gets its solvers. Throws Error (usage) if the solver cannot step such a tissue.
using TissueMaker = std::function<std::unique_ptr<TissueSolver>(const TissueParameters&)>;

}  // namespace thimble
