// The solvers a scene can be stepped with, by name.
#pragma once

#include <array>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "slave_sim/stepped_tissue.hpp"
#include "slave_sim/tissue_solver.hpp"

namespace thimble {

template <class Rule>
TissueMaker stepped(double longest_step_s) {
    return [longest_step_s](const TissueParameters& parameters) {
        return std::make_unique<SteppedTissue<Rule>>(parameters, longest_step_s);
    };
}

inline constexpr std::array<std::string_view, 4> kSolverNames{"exact", "semi_implicit_euler", "rk4",
                                                              "implicit_midpoint"};

struct SolverChoice {
    std::string_view name = kSolverNames[0];  // one of kSolverNames
    // The longest step of a solver that steps; `exact` takes any in one.
    double longest_step_s = 1e-3;
};

// Throws Error (usage) if there is no solver of that name. The maker throws where a solver is unstable.
inline TissueMaker solver_maker(const SolverChoice& choice) {
    if (choice.name == "exact") {
        return [](const TissueParameters& parameters) { return std::make_unique<ExactTissue>(parameters); };
    }
    if (choice.name == SemiImplicitEuler::kName) return stepped<SemiImplicitEuler>(choice.longest_step_s);
    if (choice.name == RungeKutta4::kName) return stepped<RungeKutta4>(choice.longest_step_s);
    if (choice.name == ImplicitMidpoint::kName) return stepped<ImplicitMidpoint>(choice.longest_step_s);
    throw Error(ExitCode::kUsage, "there is no solver \"{}\": use one of {}", choice.name,
                fmt::join(kSolverNames, ", "));
}

}  // namespace thimble
