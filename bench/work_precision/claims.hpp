// This project's claims about `exact`, each with the measured value.
#pragma once

#include <string>
#include <vector>

#include "bench/work_precision/entry.hpp"

namespace thimble {

struct SolverClaim {
    std::string text;
    std::string measured;
    bool holds;
};

std::vector<SolverClaim> judge_claims(const std::vector<Entry>& entries, double asleep_ns_per_step);

std::string claims_table(const std::vector<SolverClaim>& claims);

}  // namespace thimble
