#include "bench/work_precision/entry.hpp"

#include <exception>
#include <memory>

#include "common/error.hpp"

namespace thimble {

namespace {

struct EnteredSolver {
    std::unique_ptr<TissueSolver> solver;
    std::unique_ptr<CostMeter> meter;  // null if there is nothing to time
};

EnteredSolver enter_contestant(const ReferenceSolution& solution, Entry& entry) {
    EnteredSolver entered;
    try {
        entered.solver = entry.contestant.make(entry.problem->tissue);
    } catch (const Error& refused) {
        entry.outcome = Outcome::kUnstable;
        entry.why = refused.what();
        return entered;
    }
    try {
        entry.accuracy = judge(*entry.problem, solution, *entered.solver);
    } catch (const std::exception& gave_up) {  // odeint has exceptions of its own
        entry.outcome = Outcome::kFailed;
        entry.why = gave_up.what();
        return entered;
    }
    entry.evaluations_per_ms = static_cast<double>(entry.contestant.evaluations(*entered.solver)) /
                               (entry.problem->duration_s * 1e3);
    if (entry.accuracy.diverged) {
        entry.outcome = Outcome::kDiverged;
        return entered;
    }
    if (entry.accuracy.events_differ) entry.outcome = Outcome::kEventsDiffer;
    entered.meter = std::make_unique<CostMeter>(*entry.problem, *entered.solver);
    return entered;
}

}  // namespace

std::string_view to_string(Outcome outcome) {
    switch (outcome) {
        case Outcome::kOk:
            return "ok";
        case Outcome::kEventsDiffer:
            return "events differ";
        case Outcome::kDiverged:
            return "diverged";
        case Outcome::kUnstable:
            return "unstable";
        case Outcome::kFailed:
            break;
    }
    return "failed";
}

std::vector<Entry> run_problem(const Problem& problem, const std::vector<Contestant>& contestants,
                               unsigned runs) {
    constexpr double kEnough_s = 0.5;  // per entry; a slow solver is timed well in few runs
    constexpr unsigned kLeastRuns = 3;
    const ReferenceSolution solution = solve_reference(problem);
    std::vector<Entry> entries;
    std::vector<EnteredSolver> solvers;
    for (const Contestant& contestant : contestants) {
        Entry entry;
        entry.problem = &problem;
        entry.contestant = contestant;
        solvers.push_back(enter_contestant(solution, entry));
        entries.push_back(std::move(entry));
    }
    for (unsigned run = 0; run < runs; ++run) {
        for (EnteredSolver& entered : solvers) {
            if (entered.meter && (run < kLeastRuns || entered.meter->total_s() < kEnough_s))
                entered.meter->run();
        }
    }
    for (std::size_t i = 0; i < solvers.size(); ++i) {
        if (solvers[i].meter) entries[i].cost = solvers[i].meter->cost();
    }
    return entries;
}

const Entry* cheapest(const std::vector<Entry>& entries, const Problem& problem, std::string_view solver,
                      double position_error_m) {
    const Entry* best = nullptr;
    for (const Entry& entry : entries) {
        if (entry.problem != &problem || entry.contestant.solver != solver) continue;
        if (entry.outcome != Outcome::kOk || entry.accuracy.position_m > position_error_m) continue;
        if (best == nullptr || entry.cost.least_ns_per_ms < best->cost.least_ns_per_ms) best = &entry;
    }
    return best;
}

}  // namespace thimble
