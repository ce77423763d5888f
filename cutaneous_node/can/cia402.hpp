// The state machine of a drive (CiA 402): what a statusword (0x6041) says, which controlword (0x6040) comes next, and the
// machine itself, for the emulated drive. Transitions are numbered as in the profile.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"

namespace thimble {

enum class DriveState : std::uint8_t {
    kNotReady,
    kSwitchOnDisabled,
    kReadyToSwitchOn,
    kSwitchedOn,
    kOperationEnabled,
    kQuickStop,
    kFaultReaction,
    kFault,
};
const char* to_string(DriveState state);

enum class DriveMode : std::int8_t { kNone = 0, kSyncPosition = 8, kSyncTorque = 10 };  // 0x6060

inline constexpr std::uint16_t kControlDisableVoltage = 0x00, kControlQuickStop = 0x02,
                               kControlShutdown = 0x06, kControlSwitchOn = 0x07, kControlEnable = 0x0f,
                               kControlFaultReset = 0x80;

DriveState state_of(std::uint16_t statusword);
// The next step from `state` towards operation; a fault is reset by an edge, so the word before must not have had that bit.
std::uint16_t control_towards_operation(DriveState state);

// A time as object 0x60C2 has it: count x 10^exponent seconds. Between two targets a drive interpolates for so long.
struct InterpolationTime {
    std::uint8_t count = 0;
    std::int8_t exponent = 0;
};
// Nothing: 0x60C2 has no such time. Whole milliseconds are said in milliseconds, which every drive takes.
std::optional<InterpolationTime> interpolation_time(Duration cycle);

// The drive's side.
class DriveAutomaton {
  public:
    DriveState state() const { return state_; }
    std::uint16_t statusword() const;

    void obey(std::uint16_t controlword);
    void fail() { state_ = DriveState::kFault; }  // reaction: power off at once (0x605E = 0)

  private:
    DriveState state_ = DriveState::kSwitchOnDisabled;
    std::uint16_t last_ = 0;
};

// The CANopen master's settings of its drives.
struct CanMasterSettings {
    std::vector<std::uint8_t> nodes;  // all different, 1 to 126
    DriveMode mode = DriveMode::kSyncTorque;
    Duration cycle = std::chrono::milliseconds{4};  // of SYNC
    // Silence that is a loss, in both directions: what the master allows a drive and a drive the master.
    Duration silent_after = std::chrono::milliseconds{100};
    Duration boot_limit = std::chrono::seconds{3};
    Duration answer_limit = std::chrono::milliseconds{500};  // of one SDO, asked up to five times
    Duration enable_limit = std::chrono::seconds{2};
    std::uint8_t master_node = 127;
};

}  // namespace thimble
