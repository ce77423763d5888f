// What a session asks of this build and machine's programs, looked at before anything is written or started.
#pragma once

#include "session/settings/system_settings.hpp"

namespace thimble {

// Throws Error (usage): a device of a node on this machine for which this build has no driver (THIMBLE_DEVICES=OFF), or letters of
// [instructions] that the window's font lacks (where there are windows).
void check_build(const SystemSettings& settings);

}  // namespace thimble
