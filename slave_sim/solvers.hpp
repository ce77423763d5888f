// The solvers a scene can be stepped with, by name.
#pragma once

#include <array>
#include <string_view>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

inline constexpr std::array<std::string_view, 4> kSolverNames{"exact", "semi_implicit_euler", "rk4",
                                                              "implicit_midpoint"};

struct SolverChoice {
    std::string_view name = kSolverNames[0];  // one of kSolverNames
    // The longest step of a solver that steps; `exact` takes any in one.
    double longest_step_s = 1e-3;
};

// Throws Error (usage) if there is no solver of that name. The maker throws where a solver is unstable.
TissueMaker solver_maker(const SolverChoice& choice);

}  // namespace thimble
