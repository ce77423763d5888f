// Table [handle.falcon] of a session file.
#pragma once

#include <string>

#include "master/devices/axis_constraint.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

struct FalconSettings {
    AxisSettings axis{2, -1, 0.125};               // towards the base; from the middle of the workspace
    std::string serial;                            // of the USB device; empty: the only one
    std::string firmware;                          // a file; empty: the device must have been loaded already
    std::string firmware_sha256;                   // 64 hexadecimal digits; needed with a file
    double motor_gain_per_Nm = 10000;              // counts for each Nm at a leg [A]; a calibration
    std::uint8_t stop_buttons = kFalconAnyButton;  // of FalconButton: these are emergency stops
    Duration homing_limit = std::chrono::seconds{60};  // for the user, before the node is ready
};

}  // namespace thimble
