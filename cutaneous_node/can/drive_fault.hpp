// Faults of a drive or its bus, each with its message: which device, why, what to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace thimble {

enum class DriveFaultKind : std::uint8_t {
    // during start-up of the drives; `step` names the step
    kNoBootUp,
    kNoAnswer,      // to an SDO
    kAborted,       // an SDO; code: why
    kNotThatDrive,  // code: its device type
    kNoMode,        // code: its modes
    kNoRatedTorque,
    kStuck,  // code: the statusword it stays at
    kNoTakeUp,
    // at any time
    kHeartbeatLost,
    kDataLost,    // no process data
    kDataLength,  // code: how long it was
    kEmergency,   // code: of the EMCY
    kRebooted,
    kDuplicate,
    kLeftOperation,  // code: statusword
    kSlack,
    kNoDevice,  // for the hand that is asked for
    // of all drives
    kBusOff,
    kBusDown,
    kQueueFull,  // frames do not get onto it
};

struct DriveFault {
    DriveFaultKind kind = DriveFaultKind::kNoAnswer;
    std::size_t drive = 0;  // index in the settings
    const char* step = "";  // a literal
    std::uint32_t code = 0;
};

// `device`: "drive 5 (acting hand, thumb, cable 2)".
std::string describe(const DriveFault& fault, const std::string& device, const std::string& bus);

}  // namespace thimble
