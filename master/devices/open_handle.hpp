// The handle that a session file names, found and made ready, with whoever holds it: the one place that chooses.
#pragma once

#include <memory>

#include "common/runtime/runtime_settings.hpp"
#include "master/devices/handle.hpp"
#include "master/devices/handle_settings.hpp"
#include "master/operator/operator_parameters.hpp"

namespace thimble {

// A driver with a thread is scheduled as `runtime` says. Throws Error with what is missing and what to do about it; usage, if this
// build has no driver for it (THIMBLE_DEVICES=OFF).
std::shared_ptr<Handle> open_handle(const HandleSettings& settings, const OperatorParameters& person,
                                    const RuntimeSettings& runtime);

}  // namespace thimble
