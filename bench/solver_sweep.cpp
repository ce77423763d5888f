#include "bench/solver_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "bench/peers/cvode_tissue.hpp"
#include "bench/peers/odeint_tissue.hpp"
#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kOwnSolvers = kSolverNames.size();

TissueMaker maker(std::string_view solver, double step_s, double tolerance) {
    if (std::isnan(tolerance)) return solver_maker({solver, std::isnan(step_s) ? 1e-3 : step_s});
    if (solver == "boost_odeint")
        return [=](const TissueParameters& p) { return std::make_unique<OdeintTissue>(p, tolerance); };
    const CvodeMethod method = solver.starts_with("cvode_adams") ? CvodeMethod::kAdams : CvodeMethod::kBdf;
    const CvodeJump jump = solver.ends_with("_on") ? CvodeJump::kGoOn : CvodeJump::kRestart;
    return
        [=](const TissueParameters& p) { return std::make_unique<CvodeTissue>(p, tolerance, method, jump); };
}

SolverRun judged_run(const Problem& problem, const ReferenceSolution& truth, std::string_view solver,
                     double step_s, double tolerance) {
    SolverRun run{&problem, solver, step_s, tolerance};
    try {
        run.tissue = maker(solver, step_s, tolerance)(problem.tissue);
    } catch (const Error&) {
        run.outcome = "unstable";
        return run;
    }
    try {
        run.accuracy = judge(problem, truth, *run.tissue);
        if (run.accuracy.events_differ) run.outcome = "events differ";
        if (run.accuracy.diverged) run.outcome = "diverged";
    } catch (const std::exception&) {  // odeint has exceptions of its own
        run.outcome = "failed";
    }
    return run;
}

std::vector<SolverRun> judged_runs(const Problem& problem, bool quick) {
    using Values = std::vector<double>;
    const Values steps_s = quick ? Values{1e-3, 1e-4} : Values{1e-3, 1e-4, 1e-5, 1e-6};
    const Values tolerances = quick ? Values{1e-6, 1e-10} : Values{1e-4,  1e-5,  1e-6,  1e-7,  1e-8, 1e-9,
                                                                   1e-10, 1e-11, 1e-12, 1e-13, 1e-14};
    const ReferenceSolution truth = solve_reference(problem);
    std::vector<SolverRun> runs;
    runs.push_back(judged_run(problem, truth, kSweptSolvers[0], kNaN, kNaN));
    for (std::size_t i = 1; i < kSweptSolvers.size(); ++i) {
        const bool steps = i < kOwnSolvers;
        for (const double setting : steps ? steps_s : tolerances)
            runs.push_back(
                judged_run(problem, truth, kSweptSolvers[i], steps ? setting : kNaN, steps ? kNaN : setting));
    }
    return runs;
}

// Walks the problem as often as it takes for the clock to be fine enough.
double walk_ns_per_ms(const Problem& problem, const std::vector<double>& needle_m, TissueSolver& tissue) {
    constexpr Duration kFineEnough{100'000};
    Transitions transitions(64);
    const SessionTime start = wall_now();
    Duration taken{0};
    double simulated_ms = 0;
    for (; taken < kFineEnough; taken = wall_now() - start) {
        tissue.reset(needle_m[0]);
        for (std::size_t i = 1; i < needle_m.size(); ++i) {
            transitions.clear();
            tissue.advance(problem.step_s, needle_m[i], transitions);
        }
        simulated_ms += 1e3 * problem.duration_s;
    }
    return static_cast<double>(taken.count()) / simulated_ms;
}

}  // namespace

std::vector<SolverRun> sweep_solvers(const Problem& problem, bool quick) {
    constexpr double kEnough_ns = 0.5e9;  // per setting; a slow solver is timed well in few rounds
    constexpr int kFewestRounds = 3, kRounds = 15;
    std::vector<SolverRun> runs = judged_runs(problem, quick);
    const std::vector<double> needle_m = problem.needle_samples_m();
    for (int round = 0; round < (quick ? kFewestRounds : kRounds); ++round) {
        for (SolverRun& run : runs) {
            const double spent_ns = round * run.least_ns_per_ms * 1e3 * problem.duration_s;
            if (!run.finished() || (round >= kFewestRounds && spent_ns > kEnough_ns)) continue;
            const double ns_per_ms = walk_ns_per_ms(problem, needle_m, *run.tissue);
            run.least_ns_per_ms = round == 0 ? ns_per_ms : std::min(run.least_ns_per_ms, ns_per_ms);
        }
    }
    return runs;
}

}  // namespace thimble
