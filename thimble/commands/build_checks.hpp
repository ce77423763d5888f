// Checks this build and this machine's programs for a session, before the first file and the first node.
#pragma once

#include "session/settings/system_settings.hpp"

namespace thimble {

// Throws Error (usage): a device of a node on this machine for which this build has no driver (THIMBLE_DEVICES=OFF), or letters of
// [instructions] that the window's font lacks (where there are windows).
void check_build(const SystemSettings& settings);

}  // namespace thimble
