// One line of the study: a solver at a setting on a problem.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/accuracy.hpp"
#include "bench/work_precision/contestant.hpp"
#include "bench/work_precision/cost.hpp"

namespace thimble {

enum class Outcome {
    kOk,
    kEventsDiffer,  // errors are given all the same
    kDiverged,
    kUnstable,  // the solver refuses the tissue
    kFailed,    // it gave up on the way
};

std::string_view to_string(Outcome outcome);

struct Entry {
    const Problem* problem = nullptr;
    Contestant contestant;
    Outcome outcome = Outcome::kOk;
    std::string why;  // of kUnstable and kFailed
    Accuracy accuracy;
    double evaluations_per_ms = 0;
    Cost cost;

    bool finished() const { return outcome == Outcome::kOk || outcome == Outcome::kEventsDiffer; }
};

// Every contestant on one problem. `runs` timed runs each, interleaved, fewer of those that take long.
std::vector<Entry> run_problem(const Problem& problem, const std::vector<Contestant>& contestants,
                               unsigned runs);

// The cheapest entry of a solver on a problem whose position error does not exceed the limit and whose events
// are the reference's; null if there is none.
const Entry* cheapest(const std::vector<Entry>& entries, const Problem& problem, std::string_view solver,
                      double position_error_m);

}  // namespace thimble
