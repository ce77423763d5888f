// The table [cutaneous]:
//   device = "simulated"     or "board": a fingertip board on USB, which one says [cutaneous.board] (docs/board-protocol.md)
//                            or "drives": motors on a CAN bus, table [cutaneous.drives] (drive_settings.hpp)
//   dead_time_s = 0.045      from a command to the first motion of the cables
//   time_constant_s = 0      first-order lag after it, 0: none
//   force_limit_N = 1.5      the most the device presses
//   stale = "zero"           what the fingers feel without feedback: slack at once ("zero"), "ramp" or "hold"
//   stale_after_s = 0.1      without feedback for so long
//   stale_ramp_s = 0.02      of "ramp": how long the force takes to fall
//   guard_limit_N = 5        the last stage before the device lets no more through, whoever asks
//   percept_period_s = 0.001 how often the skin reports
#pragma once

#include "common/config.hpp"
#include "common/hid/hid_link.hpp"
#include "common/shared_values.hpp"
#include "common/stale_policy.hpp"
#include "common/time.hpp"
#include "cutaneous_node/drive_settings.hpp"

namespace thimble {

enum class FingertipDevice : std::uint8_t { kSimulated, kBoard, kDrives };

struct CutaneousSettings {
    Duration dead_time = std::chrono::milliseconds{45};
    Duration time_constant{};
    double force_limit_N = kFingerFullScale_N;
    StalePolicy stale{StaleMode::kZero};
    double guard_limit_N = 5;  // the last stage before the device
    Duration percept_period = std::chrono::milliseconds{1};
    FingertipDevice device = FingertipDevice::kSimulated;
    HidChoice board{};       // kBoard
    DriveSettings drives{};  // kDrives
    // Of the force in HF, what the handle gives: 1, but with [control] compensator = "scaled". The rest is for the skin.
    double hand_share = 1;
};

CutaneousSettings read_cutaneous_settings(const ConfigTable& table);

}  // namespace thimble
