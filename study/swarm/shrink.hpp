// The smallest case that still fails.
#pragma once

#include "study/swarm/swarm_trial.hpp"

namespace thimble {

// Removes faults, keys, the second trial and the lab key, as long as the case breaks the same invariant.
SwarmCase shrink(SwarmCase one, Rule broken, const BreakForce& break_force = {});

}  // namespace thimble
