#include "slave_sim/tissue_solver.hpp"

#include <cassert>

namespace thimble {

TissueSolver::TissueSolver(const TissueParameters& parameters) : parameters_(parameters) {
    assert(parameters.mass_kg > 0 && parameters.damping_Ns_per_m >= 0 && parameters.stiffness_N_per_m >= 0);
    assert(parameters.drag_Ns_per_m >= 0 && parameters.puncture_force_N > 0);
}

void TissueSolver::reset(double position_needle_m) {
    needle_m_ = position_needle_m - parameters_.rest_position_m;
    phase_ = needle_m_ > 0 ? TissuePhase::kPenetrated : TissuePhase::kFree;
    surface_m_ = 0;
    velocity_needle_m_per_s_ = 0;
    velocity_surface_m_per_s_ = 0;
    position_needle_m_ = position_needle_m;
    restart();
}

void TissueSolver::step(const NeedleStep& step, Transitions& transitions) {
    const double rest_m = parameters_.rest_position_m;
    const double end_m = step.to_m - rest_m;
    needle_m_ = step.from_m - rest_m;
    // From the differences to the rest position, which are small where it matters.
    velocity_needle_m_per_s_ = (end_m - needle_m_) / step.duration_s;
    move(step.duration_s, end_m, transitions);
    needle_m_ = end_m;
    position_needle_m_ = step.to_m;
    if (phase_ == TissuePhase::kFree) settle();
}

void TissueSolver::advance(double duration_s, double position_needle_m, Transitions& transitions) {
    assert(duration_s >= 0);
    if (duration_s == 0) return;
    NeedleStep line;
    line.duration_s = duration_s;
    line.from_m = position_needle_m_;
    line.to_m = position_needle_m;
    step(line, transitions);
}

// The energy of a free surface only falls, so it stays within sqrt(x^2 + v^2 M / K); without stiffness it
// comes to rest within v M / B. Subnormal squares are as good as zero here.
void TissueSolver::settle() {
    const TissueParameters& p = parameters_;
    const double x = surface_m_;
    const double v = velocity_surface_m_per_s_;
    if (p.stiffness_N_per_m > 0) {
        constexpr double kStillSquared = kStillMetres * kStillMetres;
        if (p.stiffness_N_per_m * x * x + p.mass_kg * v * v >= p.stiffness_N_per_m * kStillSquared) return;
        surface_m_ = 0;
    } else if (p.mass_kg * (v < 0 ? -v : v) >= p.damping_Ns_per_m * kStillMetres) {
        return;
    }
    velocity_surface_m_per_s_ = 0;
}

TissueState TissueSolver::state() const {
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

}  // namespace thimble
