// One case of the swarm, from its start to its end.
#pragma once

#include <optional>

#include "study/swarm/watched_parts.hpp"

namespace thimble {

struct SwarmOutcome {
    std::optional<Violation> violation;
    std::uint64_t digest = 0;  // of all outputs and samples
    double simulated_s = 0;
    std::vector<EndReason> ends;  // of the trials
};

// Removes from the case the keys that a reader refuses. `break_force`: null, but in a test that breaks something.
SwarmOutcome run_case(SwarmCase& one, const BreakForce& break_force = {});

}  // namespace thimble
