// Every tissue solver at every setting of the sweep on one problem: its errors and its cost.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "bench/accuracy.hpp"

namespace thimble {

struct SolverRun {
    const Problem* problem;
    std::string_view solver;
    double step_s, tolerance;  // longest step; absolute and relative tolerance. NaN where a solver has none
    // "ok", "events differ" (with errors all the same), "diverged", "unstable" (the solver refuses the tissue), "failed" (in a step).
    std::string_view outcome = "ok";
    Accuracy accuracy{};
    double least_ns_per_ms = 0;  // wall time per simulated millisecond, of the run that was disturbed least
    std::unique_ptr<TissueSolver> tissue{};

    bool finished() const { return outcome == "ok" || outcome == "events differ"; }
};

// In the order of the tables. CVODE restarts at the jumps of the needle's velocity, or goes on (`_on`).
inline constexpr std::array<std::string_view, 9> kSweptSolvers{
    "exact",     "semi_implicit_euler", "rk4",         "implicit_midpoint", "boost_odeint", "cvode_adams",
    "cvode_bdf", "cvode_adams_on",      "cvode_bdf_on"};

// Steps from 1e-3 to 1e-6 s and tolerances from 1e-4 to 1e-14; few settings if `quick`. Timed runs are interleaved.
std::vector<SolverRun> sweep_solvers(const Problem& problem, bool quick);

}  // namespace thimble
