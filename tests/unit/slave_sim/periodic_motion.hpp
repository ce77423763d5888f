// Where a surface swings for ever if the needle in it repeats a closed polygon: the fixed point of one period,
// which every rule maps affinely, x -> A x + b. In 100-digit numbers and by formulas of its own.
#pragma once

#include <string_view>
#include <vector>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

// The needle's positions relative to the surface's rest, one a step; the last leads back to the first. It
// stays beneath the surface (not checked).
struct Polygon {
    double step_s;
    std::vector<double> needle_m;
};

struct SurfaceSample {
    double position_m;  // relative to the rest
    double velocity_m_per_s;
};

// After the step that leads to each corner. `solver` is one of kSolverNames; all but `exact` by their own rule,
// one step from corner to corner: what is left of a solver's error is rounding.
std::vector<SurfaceSample> periodic_motion(std::string_view solver, const TissueParameters& parameters,
                                           const Polygon& polygon);

}  // namespace thimble
