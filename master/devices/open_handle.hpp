// The real handle that a session file names, found and made ready.
#pragma once

#include <memory>

#include "master/devices/handle_settings.hpp"
#include "master/devices/real_handle.hpp"

namespace thimble {

// Null for the kinds that are simulated. Throws Error with what is missing and what to do about it.
std::unique_ptr<RealHandle> open_handle(const HandleSettings& settings);

}  // namespace thimble
