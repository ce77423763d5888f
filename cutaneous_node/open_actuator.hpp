// The fingertip actuator that a session file names, opened: the one place that chooses.
#pragma once

#include <functional>
#include <memory>

#include <nlohmann/json_fwd.hpp>

#include "common/runtime/runtime_settings.hpp"
#include "common/runtime/sockets.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

struct OpenActuator {
    std::shared_ptr<FingertipActuator> actuator;  // with all it needs; releases the finger at its end
    // Before the node says that it is ready, with time limits of its own. Throws Error with which device, which step, why and what
    // to do.
    std::function<void()> bring_up = [] {};
    // Adds its part, if it has one, to the node's report.
    std::function<void(nlohmann::ordered_json& report)> describe = [](nlohmann::ordered_json&) {};
};

// A driver with a thread is scheduled as `runtime` says; one that talks over UDP takes its sockets from `sockets`. Throws Error with
// what is missing and what to do about it; usage, if this build has no driver for it (THIMBLE_DEVICES=OFF).
OpenActuator open_actuator(const CutaneousSettings& settings, const RuntimeSettings& runtime,
                           Sockets& sockets);

}  // namespace thimble
