// A session's settings with another delay compensator in HF, on both sides of the network.
#pragma once

#include <string_view>
#include <vector>

#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// [control] of the settings if it is that compensator, else that compensator's defaults.
ControlSettings control_for(const SystemSettings& settings, Compensator compensator);

// Handle, finger and slave do what `control` says.
SystemSettings with_control(SystemSettings settings, const ControlSettings& control);

// Those of the protocols' trials that are done with HF, in their order.
std::vector<TrialConditions> force_feedback_trials(const std::vector<Protocol>& protocols);

// Which compensator acts in each trial of a session with these settings.
void name_compensators(std::vector<TrialConditions>& trials, const SystemSettings& settings);

// Throws Error (usage) for a name that is no compensator; "none" is none.
Compensator parse_compensator(std::string_view name);

}  // namespace thimble
