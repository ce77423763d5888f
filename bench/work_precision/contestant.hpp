// Every solver at every setting of the sweep, behind one interface.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

struct Contestant {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

    std::string_view solver;
    double step_s = kNone;     // longest, of a solver that steps; NaN otherwise
    double tolerance = kNone;  // absolute and relative, of a solver that controls its step; NaN otherwise
    TissueMaker make;          // throws Error if the solver cannot step such a tissue
    // Of the right-hand side, or propagators, by one that `make` made, since it was made.
    std::function<std::uint64_t(const TissueSolver&)> evaluations;

    std::string setting() const;  // "h = 0.0001 s", "tolerance 1e-06"; empty for `exact`
};

// In the order of tables: `exact` first.
inline constexpr std::string_view kExactName = "exact";
const std::vector<std::string_view>& contestant_names();

// Steps from 1e-3 to 1e-6 s and tolerances from 1e-4 to 1e-14; fewer if `quick`.
std::vector<Contestant> sweep(bool quick);

// One of each solver: steps of `step_s`, tolerances of 1e-9.
std::vector<Contestant> one_of_each(double step_s);

}  // namespace thimble
