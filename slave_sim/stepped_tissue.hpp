// The tissue automaton by fixed steps of a general-purpose rule, the way most simulations are written: no
// event is located. A guard is looked at when a step is done, so a transition comes up to one step late, and
// a surface that the needle has passed is put on the needle.
//
// A rule advances M x'' = V z_n' - (B + V) x' - K x (V only beneath the surface) by h:
//
//   semi_implicit_euler  v += h a(x, v), x += h v             order 1
//   rk4                  classical Runge-Kutta                order 4 between transitions
//   implicit_midpoint    v, x from the midpoint of the step   order 2, stable at every step
//
// All three are order 1 across a transition.
#pragma once

#include <cstdint>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

// The input of one rule: the constants of x'' = drive - damping x' - stiffness x.
struct SurfaceLaw {
    double drive_m_per_s2;
    double damping_per_s;
    double stiffness_per_s2;
};

struct SurfaceMotion {
    double position_m;
    double velocity_m_per_s;
};

struct SemiImplicitEuler {
    static constexpr const char* kName = "semi_implicit_euler";
    static constexpr unsigned kStages = 1;
    static SurfaceMotion advance(const SurfaceLaw& law, const SurfaceMotion& from, double h);
};

struct RungeKutta4 {
    static constexpr const char* kName = "rk4";
    static constexpr unsigned kStages = 4;
    static SurfaceMotion advance(const SurfaceLaw& law, const SurfaceMotion& from, double h);
};

struct ImplicitMidpoint {
    static constexpr const char* kName = "implicit_midpoint";
    static constexpr unsigned kStages = 1;
    static SurfaceMotion advance(const SurfaceLaw& law, const SurfaceMotion& from, double h);
};

template <class Rule>
class SteppedTissue final : public TissueSolver {
  public:
    // A step longer than longest_step_s (> 0) is divided into equal parts. Throws Error (usage) if the rule
    // is not stable at that step, naming the longest one that is.
    SteppedTissue(const TissueParameters& parameters, double longest_step_s);

    // Of the surface's acceleration: steps times stages.
    std::uint64_t evaluations() const { return evaluations_; }

  protected:
    void move(double duration_s, double needle_end_m, Transitions& transitions) override;

  private:
    void obey_guards(double offset_s, Transitions& transitions);
    void enter(TissuePhase phase, double offset_s, Transitions& transitions);

    double longest_step_s_;
    std::uint64_t evaluations_ = 0;
};

extern template class SteppedTissue<SemiImplicitEuler>;
extern template class SteppedTissue<RungeKutta4>;
extern template class SteppedTissue<ImplicitMidpoint>;

}  // namespace thimble
