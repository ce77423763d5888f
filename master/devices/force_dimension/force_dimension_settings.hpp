// Table [handle.force_dimension] of a session file.
#pragma once

#include <string>

#include "master/devices/axis_constraint.hpp"

namespace thimble {

struct ForceDimensionSettings {
    AxisSettings axis{0, -1};  // pushing away from the user
    std::string library;       // empty: where DhdLibrary looks
    int serial = 0;            // 0: the only one
    int stop_button = -1;      // which of the SDK's buttons is an emergency stop; -1: none
    bool gravity_compensation = true;
    bool watchdog = true;  // refuse a device whose watchdog cannot be set
};

}  // namespace thimble
