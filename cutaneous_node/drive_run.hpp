// Drives in real time: what programs with real or emulated ones share.
#pragma once

#include <nlohmann/json.hpp>

#include "cutaneous_node/drive_actuator.hpp"

namespace thimble {

// Until every drive is in operation and every cable taut. Throws Error (run failed) in the words of the actuator, or if a stop is
// requested before.
void bring_up_drives(DriveActuator& actuator);

nlohmann::ordered_json describe_drives(const DriveActuator& actuator);

}  // namespace thimble
