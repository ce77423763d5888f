// The named problems on which solvers are weighed: a tissue and a needle.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

struct Problem {
    std::string_view name;
    std::string_view about;
    TissueParameters tissue;
    double duration_s;
    double step_s;  // between two samples of the needle
    std::function<double(double t_s)> needle_m;

    // At 0, step, 2 step, ... to the end of the duration.
    std::vector<double> needle_samples_m() const;
};

const std::vector<Problem>& problems();

// Throws Error (usage) that lists the names.
const Problem& problem_named(std::string_view name);

}  // namespace thimble
