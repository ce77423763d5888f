#include "bench/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thimble {

namespace {

struct SolverEvent {
    std::size_t step;
    double offset_s;
    std::string_view phase;
};

double distance(double value, const ReferenceNumber& truth) {
    if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
    return abs(ReferenceNumber(value) - truth).convert_to<double>();
}

void judge_sample(const ReferenceState& truth, bool at_event, const TissueState& state, Accuracy& accuracy) {
    const auto widen = [](double& greatest, double error) { greatest = std::max(greatest, error); };
    widen(accuracy.position_m, distance(state.position_surface_m, truth.position_surface_m));
    if (at_event) return;
    widen(accuracy.velocity_m_per_s,
          distance(state.velocity_surface_m_per_s, truth.velocity_surface_m_per_s));
    widen(accuracy.force_N, distance(state.force_N, truth.force_N));
}

void judge_events(const std::vector<SolverEvent>& found, const std::vector<ReferenceEvent>& truth,
                  double step_s, Accuracy& accuracy) {
    accuracy.events = found.size();
    accuracy.events_reference = truth.size();
    accuracy.events_differ = found.size() != truth.size();
    for (std::size_t i = 0; i < truth.size() && !accuracy.events_differ; ++i) {
        accuracy.events_differ = found[i].phase != to_string(truth[i].phase);
        const ReferenceNumber start_s = ReferenceNumber(step_s) * found[i].step;
        accuracy.event_time_s =
            std::max(accuracy.event_time_s, distance(found[i].offset_s, truth[i].t_s - start_s));
    }
    if (accuracy.events_differ || truth.empty()) {
        accuracy.event_time_s = std::numeric_limits<double>::quiet_NaN();
    }
}

}  // namespace

ReferenceSolution solve_reference(const Problem& problem) {
    const std::vector<double> needle_m = problem.needle_samples_m();
    ReferenceTissue tissue{ReferenceParameters(problem.tissue)};
    ReferenceSolution solution;
    tissue.reset(needle_m[0]);
    for (std::size_t i = 1; i < needle_m.size(); ++i) {
        tissue.step(problem.step_s, needle_m[i]);
        solution.samples.push_back(tissue.state());
    }
    solution.events = tissue.events();
    solution.at_event.resize(solution.samples.size());
    for (const ReferenceEvent& event : solution.events) {
        const ReferenceNumber place = event.t_s / problem.step_s;
        const double nearest = std::round(place.convert_to<double>());
        const bool close = abs(place - nearest) * problem.step_s < kAtEvent_s;
        if (close && nearest >= 1) solution.at_event[static_cast<std::size_t>(nearest) - 1] = true;
    }
    return solution;
}

Accuracy judge(const Problem& problem, const ReferenceSolution& solution, TissueSolver& solver) {
    constexpr double kDiverged_m = 1;
    const std::vector<double> needle_m = problem.needle_samples_m();
    std::vector<SolverEvent> found;
    Accuracy accuracy;
    Transitions transitions(Transitions::kUnlimited);
    solver.reset(needle_m[0]);
    for (std::size_t i = 1; i < needle_m.size(); ++i) {
        transitions.clear();
        solver.advance(problem.step_s, needle_m[i], transitions);
        for (const Transition& t : transitions) found.push_back({i - 1, t.offset_s, t.phase});
        judge_sample(solution.samples[i - 1], solution.at_event[i - 1], solver.state(), accuracy);
        accuracy.diverged = !(accuracy.position_m < kDiverged_m);
        if (accuracy.diverged) break;
    }
    judge_events(found, solution.events, problem.step_s, accuracy);
    return accuracy;
}

}  // namespace thimble
