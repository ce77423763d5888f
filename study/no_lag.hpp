// What the actuators' lag costs: experiment 1 again, with fingertip devices that need no time.
#pragma once

#include <vector>

#include "session/settings/protocol.hpp"

namespace thimble {

// The trials of experiment 1 with CF, under the same keys, so that nothing but the lag differs; none without
// an experiment 1.
std::vector<TrialConditions> no_lag_trials(const std::vector<Protocol>& protocols);

SystemSettings without_lag(SystemSettings settings);

}  // namespace thimble
