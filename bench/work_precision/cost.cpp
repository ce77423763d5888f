#include "bench/work_precision/cost.hpp"

#include <algorithm>

#include "common/runtime/wall_clock.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

CostMeter::CostMeter(const Problem& problem, TissueSolver& solver)
    : solver_(solver),
      step_s_(problem.step_s),
      simulated_ms_(problem.duration_s * 1e3),
      needle_m_(problem.needle_samples_m()) {}

void CostMeter::walk() {
    solver_.reset(needle_m_[0]);
    NeedleStep step;
    step.duration_s = step_s_;
    for (std::size_t i = 1; i < needle_m_.size(); ++i) {
        transitions_.clear();
        step.from_m = needle_m_[i - 1];
        step.to_m = needle_m_[i];
        solver_.step(step, transitions_);
    }
}

void CostMeter::run() {
    constexpr Duration kFineEnough{100'000};
    const SessionTime start = wall_now();
    Duration taken{0};
    double walks = 0;
    while (taken < kFineEnough) {
        walk();
        ++walks;
        taken = wall_now() - start;
    }
    total_s_ += to_seconds(taken);
    runs_ns_per_ms_.push_back(static_cast<double>(taken.count()) / (walks * simulated_ms_));
}

Cost CostMeter::cost() const {
    std::vector<double> sorted = runs_ns_per_ms_;
    std::sort(sorted.begin(), sorted.end());
    return {sorted.front(), sorted[sorted.size() / 2], sorted.size()};
}

double asleep_ns_per_step() {
    constexpr unsigned kRuns = 20;
    constexpr unsigned kSteps = 100'000;
    NeedleScene scene(paper_scene(), solver_maker({}));
    scene.reset({});
    double least_ns = 1e9;
    for (unsigned run = 0; run < kRuns; ++run) {
        const SessionTime start = wall_now();
        for (unsigned i = 0; i < kSteps; ++i) {
            const double position_m = i % 2 == 0 ? 0.001 : 0.002;
            scene.step(i * 1e-3, 1e-3, {position_m, position_m});
        }
        least_ns = std::min(least_ns, static_cast<double>((wall_now() - start).count()) / kSteps);
    }
    return least_ns;
}

}  // namespace thimble
