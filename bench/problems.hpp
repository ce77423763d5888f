// The named problems on which solvers are weighed: a tissue and a needle.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

enum class ProblemKind {
    kSmooth,  // a smooth needle that crosses every guard at a finite speed: claims of accuracy hold here
    kRough,   // a needle with corners, or one that is quantised
    kDiscontinuous,  // the number of transitions depends on the last bit: reported, and compared with caution
};

std::string_view to_string(ProblemKind kind);

struct Problem {
    std::string_view name;
    std::string_view about;
    ProblemKind kind;
    TissueParameters tissue;
    double duration_s;
    double step_s;  // between two samples of the needle
    std::function<double(double t_s)> needle_m;

    // At 0, step, 2 step, ... to the end of the duration.
    std::vector<double> needle_samples_m() const { return needle_samples_m(step_s); }
    std::vector<double> needle_samples_m(double at_step_s) const;
};

const std::vector<Problem>& problems();

// Throws Error (usage) that lists the names.
const Problem& problem_named(std::string_view name);

}  // namespace thimble
