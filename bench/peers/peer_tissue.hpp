// A tissue for general-purpose integrators, so that peers differ in nothing but the integrator. It solves contact in closed form
// (the force is a line in time) and gives the integrator one smooth phase at a time. The integrator finds the roots of needle and
// surface itself, and restarts at each transition.
//
// Causality: the needle is known to the end of the current step only. A free surface does not feel the needle, and the integrator
// may run ahead. Beneath the surface it must stop at the end of the step.
#pragma once

#include <cstdint>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

class PeerTissue : public TissueSolver {
  public:
    using TissueSolver::TissueSolver;

  protected:
    struct Surface {
        double position_m;
        double velocity_m_per_s;
    };
    struct Arrival {
        bool crossed;  // at t_s; otherwise t_s is the end of the step
        double t_s;
        Surface surface;
    };

    // Begins anew: another mode, or a surface that was put elsewhere.
    virtual void start(double t_s, const Surface& surface) = 0;
    // The needle's velocity, and with it the drive, has jumped; the surface has not.
    virtual void drive_changed() = 0;
    // To the end of the step, or to where gap_m() first rises above zero. Throws Error (run failed).
    virtual Arrival integrate(double from_s, double end_s) = 0;

    double acceleration(double position_m, double velocity_m_per_s) {
        ++evaluations_;
        return (drive_N_ - damping_Ns_per_m_ * velocity_m_per_s -
                parameters_.stiffness_N_per_m * position_m) /
               parameters_.mass_kg;
    }
    double damping_Ns_per_m() const { return damping_Ns_per_m_; }
    // Of needle and surface at t_s, positive where the event has happened.
    double gap_m(double t_s, double surface_m) const {
        return side_ * (leg_needle_m_ + velocity_needle_m_per_s_ * (t_s - leg_start_s_) - surface_m);
    }
    // The integrator may step beyond the end of the step.
    bool may_run_ahead() const { return phase_ != TissuePhase::kPenetrated; }
    // Throws Error (run failed) if one step has cost more than any sensible number of evaluations.
    void check_effort() const;

    void move(double duration_s, double needle_end_m, Transitions& transitions) final;
    void restart() final;

  private:
    bool contact_leg(double needle_end_m, double end_s, Transitions& transitions);
    bool moving_leg(double end_s, Transitions& transitions);
    void enter(TissuePhase phase, double t_s, Transitions& transitions);
    void prepare();

    std::uint64_t evaluations_ = 0;  // of the right-hand side in this step
    double t_s_ = 0;                 // since the reset
    double step_start_s_ = 0;
    double leg_start_s_ = 0;
    double leg_needle_m_ = 0;
    double side_ = 1;
    double damping_Ns_per_m_ = 0;
    double drive_N_ = 0;
    bool fresh_ = true;         // the integrator has to begin anew
    bool search_ = true;        // for further transitions in this step
    Surface integrated_{0, 0};  // what the integrator said last
};

}  // namespace thimble
