// Passivity observer on the tissue port: what the operator's work on a tissue became.
//
// For a solver that locates its transitions and a needle on straight lines every leg has a closed form:
//
//   contact      work K (x2^2 - x1^2) / 2 + B v (x2 - x1)
//   penetrated   work V v (v t - (x2 - x1))
//   free         work 0
//
// The automaton is not passive by itself: the force of a contact has no inertial part, so the surface takes the
// needle's velocity for nothing, at a touch and wherever the needle's velocity jumps in contact. That kinetic
// energy is `given`. The balance is then
//
//   work + given = stored + dissipated,   stored = (K x^2 + M x'^2) / 2,   dissipated = integral of
//   B x'^2 + V (x' - z_n')^2
//
// The surface is followed here by the model's own formulas from transition to transition, and the dissipation
// integrated by quadrature.
#pragma once

#include <array>

#include "slave_sim/second_order.hpp"
#include "slave_sim/tissue_solver.hpp"

namespace thimble {

class PortEnergy {
  public:
    // Surface at rest, needle on or above it.
    PortEnergy(const TissueParameters& parameters, double position_needle_m);

    // The step that the solver has made, and the transitions it reported.
    void step(double duration_s, double position_needle_m, const Transitions& transitions);

    double work_J() const { return work_J_; }
    double given_J() const { return given_J_; }  // net: a touch can also take
    double gifts_J() const { return gifts_J_; }  // what was given alone
    double dissipated_J() const { return dissipated_J_; }
    double stored_J() const;
    double imbalance_J() const { return work_J_ + given_J_ - stored_J() - dissipated_J_; }
    // Sum of the magnitudes of all that was added: what rounding is measured against.
    double turnover_J() const { return turnover_J_; }

    double position_surface_m() const { return parameters_.rest_position_m + surface_m_; }
    double velocity_surface_m_per_s() const { return velocity_surface_m_per_s_; }

  private:
    void leg(double duration_s, double needle_end_m);
    void enter(TissuePhase phase);
    void carry(double velocity_m_per_s);
    void dissipate(double duration_s);
    double loss_W(double velocity_surface_m_per_s) const;
    void add(double& sum_J, double part_J);

    TissueParameters parameters_;
    std::array<SecondOrder, 2> laws_;
    TissuePhase phase_ = TissuePhase::kFree;
    double needle_m_;  // positions relative to the surface's rest
    double surface_m_ = 0;
    double velocity_needle_m_per_s_ = 0;
    double velocity_surface_m_per_s_ = 0;
    double work_J_ = 0;
    double given_J_ = 0;
    double gifts_J_ = 0;
    double dissipated_J_ = 0;
    double turnover_J_ = 0;
};

}  // namespace thimble
