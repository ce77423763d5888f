// The real handle that a session file names, found and made ready.
#pragma once

#include <functional>
#include <memory>

#include "master/devices/handle_settings.hpp"
#include "master/devices/real_handle.hpp"

namespace thimble {

// A driver with a thread calls `prepare_thread` in it first. Null for the kinds that are simulated. Throws Error with what is missing and what to do about it.
std::unique_ptr<RealHandle> open_handle(const HandleSettings& settings,
                                        const std::function<void()>& prepare_thread);

}  // namespace thimble
