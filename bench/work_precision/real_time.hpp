// Which solver holds which rate: time of every single step.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/problems.hpp"

namespace thimble {

struct RealTimeRow {
    std::string_view problem;
    std::string_view solver;
    double step_s;
    std::string outcome;  // "ok", "unstable", "failed"
    double p50_ns = 0, p999_ns = 0, worst_ns = 0;

    // 99.9 % of the steps leave half of their period to spare. (The worst step is the scheduler's, not the
    // solver's, unless the thread runs under SCHED_FIFO on a core of its own.)
    bool holds() const { return outcome == "ok" && p999_ns <= step_s * 1e9 / 2; }
};

// Every solver at steps of 1, 0.1 and 0.01 ms, the needle sampled at that rate.
std::vector<RealTimeRow> run_real_time(const Problem& problem, bool quick);

// The cost of two readings of the clock, which every figure above contains.
double clock_ns();

}  // namespace thimble
