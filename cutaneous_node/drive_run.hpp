// Drives in real time: what programs with real or emulated ones share.
#pragma once

#include <memory>

#include <nlohmann/json.hpp>

#include "common/runtime/sockets.hpp"
#include "cutaneous_node/drive_actuator.hpp"

namespace thimble {

// The bus that [cutaneous.drives] names. A frame that arrives wakes the program, as a datagram does. Throws Error (network).
std::unique_ptr<CanBus> open_bus(const DriveSettings& settings, Sockets& sockets);

// Until every drive is in operation and every cable taut. Throws Error (run failed) in the words of the actuator, or if a stop is
// requested before.
void bring_up_drives(DriveActuator& actuator);

nlohmann::ordered_json describe_drives(const DriveActuator& actuator);

}  // namespace thimble
