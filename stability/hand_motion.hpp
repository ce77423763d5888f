// A held mass with dry friction, moved exactly under a force that stays the same for a while:
//
//     m x" + b x' + k x + f_c sgn(x') = f
//
// While x' keeps its sign that is a linear motion under f -+ f_c. Where x' comes to zero the mass sticks if |f - k x| <= f_c,
// else it turns or goes on; the root of x' is found to the last digits. SI units.
#pragma once

#include "slave_sim/second_order.hpp"
#include "stability/critical_delay.hpp"

namespace thimble {

class HandMotion {
  public:
    HandMotion(const HeldMass& hand, double position_m, double velocity_m_per_s)
        : hand_(hand.mass_kg, hand.damping_Ns_per_m, hand.stiffness_N_per_m),
          stiffness_N_per_m_(hand.stiffness_N_per_m),
          position_m_(position_m),
          velocity_m_per_s_(velocity_m_per_s) {}

    // f_c >= 0, from now on.
    void rub(double friction_N) { friction_N_ = friction_N; }
    Propagator propagator(double duration_s) const { return hand_.propagator(duration_s); }
    // Under the force f for the propagator's time.
    void advance(const Propagator& propagator, double force_N);

    double position_m() const { return position_m_; }
    double velocity_m_per_s() const { return velocity_m_per_s_; }

  private:
    void slide(const Propagator& propagator, double acceleration_m_per_s2);
    void advance_rubbing(Propagator left, double force_N);
    // When x' of a motion that goes `way` (+1, -1) is zero next; the whole time if it is not within it.
    double turn_s(double way, double acceleration_m_per_s2, const Propagator& whole) const;

    SecondOrder hand_;
    double stiffness_N_per_m_;
    double friction_N_ = 0;
    double position_m_, velocity_m_per_s_;
};

}  // namespace thimble
