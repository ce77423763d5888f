// A solver's errors on a problem, against the reference solution.
#pragma once

#include <vector>

#include "bench/problems.hpp"
#include "bench/reference_tissue.hpp"

namespace thimble {

// A sample this close to an event has no left limit that a solver in doubles could be held to: the velocity of
// the surface and the force jump there. Its position does not, and is compared at every sample.
inline constexpr double kAtEvent_s = 1e-12;

struct ReferenceSolution {
    std::vector<ReferenceState> samples;  // at the samples of the needle
    std::vector<bool> at_event;           // within kAtEvent_s of one
    std::vector<ReferenceEvent> events;
};

ReferenceSolution solve_reference(const Problem& problem);

struct Accuracy {
    // Greatest errors over the samples of the needle (1 ms apart unless the problem says otherwise).
    double position_m = 0;
    double velocity_m_per_s = 0;
    double force_N = 0;
    // Greatest over the events, compared in order; NaN if there are none or the lists differ.
    double event_time_s = 0;
    std::size_t events = 0;
    std::size_t events_reference = 0;
    bool events_differ = false;  // in number or in phase
    bool diverged = false;       // not finite, or more than 1 m off
};

// Steps the solver, from a reset, through the problem.
Accuracy judge(const Problem& problem, const ReferenceSolution& solution, TissueSolver& solver);

}  // namespace thimble
