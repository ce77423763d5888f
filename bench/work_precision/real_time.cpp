#include "bench/work_precision/real_time.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "bench/work_precision/contestant.hpp"
#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

namespace {

double quantile(const std::vector<double>& sorted, double fraction) {
    const double last = static_cast<double>(sorted.size() - 1);
    return sorted[static_cast<std::size_t>(std::ceil(fraction * last))];
}

void time_steps(const std::vector<double>& needle_m, TissueSolver& solver, RealTimeRow& row) {
    std::vector<double> times_ns;
    times_ns.reserve(needle_m.size());
    Transitions transitions;
    solver.reset(needle_m[0]);
    for (std::size_t i = 1; i < needle_m.size(); ++i) {
        transitions.clear();
        const SessionTime start = wall_now();
        solver.advance(row.step_s, needle_m[i], transitions);
        times_ns.push_back(static_cast<double>((wall_now() - start).count()));
    }
    std::sort(times_ns.begin(), times_ns.end());
    row.p50_ns = quantile(times_ns, 0.5);
    row.p999_ns = quantile(times_ns, 0.999);
    row.worst_ns = times_ns.back();
}

RealTimeRow run_one(const Problem& problem, const std::vector<double>& needle_m, const Contestant& contestant,
                    double step_s) {
    RealTimeRow row{problem.name, contestant.solver, step_s, "ok"};
    std::unique_ptr<TissueSolver> solver;
    try {
        solver = contestant.make(problem.tissue);
    } catch (const Error&) {
        row.outcome = "unstable";
        return row;
    }
    try {
        time_steps(needle_m, *solver, row);
    } catch (const std::exception&) {
        row.outcome = "failed";
    }
    return row;
}

}  // namespace

std::vector<RealTimeRow> run_real_time(const Problem& problem, bool quick) {
    const std::vector<double> steps_s =
        quick ? std::vector<double>{1e-3} : std::vector<double>{1e-3, 1e-4, 1e-5};
    std::vector<RealTimeRow> rows;
    for (const double step_s : steps_s) {
        const std::vector<double> needle_m = problem.needle_samples_m(step_s);
        for (const Contestant& contestant : one_of_each(step_s)) {
            rows.push_back(run_one(problem, needle_m, contestant, step_s));
        }
    }
    return rows;
}

double clock_ns() {
    constexpr int kReadings = 100'000;
    const SessionTime start = wall_now();
    SessionTime last = start;
    for (int i = 0; i < kReadings; ++i) last = wall_now();
    return static_cast<double>((last - start).count()) / kReadings;
}

}  // namespace thimble
