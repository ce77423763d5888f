// The cost of a solver: wall time per simulated millisecond.
#pragma once

#include <vector>

#include "bench/problems.hpp"

namespace thimble {

struct Cost {
    double least_ns_per_ms = 0;  // of the runs: what others on the machine disturb least
    double median_ns_per_ms = 0;
    std::size_t runs = 0;
};

// One solver's runs through one problem, to be interleaved with those of other solvers.
class CostMeter {
  public:
    CostMeter(const Problem& problem, TissueSolver& solver);

    // Once through the problem, or as often as it takes for the clock to be fine enough (some 100 us).
    void run();
    Cost cost() const;
    double total_s() const { return total_s_; }

  private:
    void walk();

    TissueSolver& solver_;
    double step_s_;
    double simulated_ms_;
    std::vector<double> needle_m_;
    std::vector<double> runs_ns_per_ms_;
    Transitions transitions_{64};
    double total_s_ = 0;
};

// ns per step of the paper's scene with the needle moving outside the tissue, which sleeps.
double asleep_ns_per_step();

}  // namespace thimble
