// Before a person holds a real handle: the energy that its force feedback (HF) gives to virtual subjects in virtual time, beside the
// guard's limit. An experiment about oscillation needs a larger limit than the default of a real handle (docs/safety.md).
#pragma once

#include <string>
#include <vector>

#include "session/settings/system_settings.hpp"

namespace thimble {

// The most that the handle gives out within [guard] energy_window_s, J, in an HF trial of each of so many subjects without
// energy_limit_J. `delay`: of the force path. Throws Error (run failed) naming a plug-in that crashes or does not return.
double most_given_out_J(const SystemSettings& settings, Duration delay, std::uint32_t subjects);

// A real handle, HF, and an energy_limit_J below twice the most that these delays give out: a warning that names the value which the
// session needs. Otherwise "". Throws Error as most_given_out_J() does.
std::string energy_warning(const SystemSettings& settings, const std::vector<Duration>& delays);
// Of the session's own trials.
std::string energy_warning(const SystemSettings& settings);

}  // namespace thimble
