// The table [cutaneous] of a session file: the fingertip device (docs/session-files.md).
#pragma once

#include "common/config.hpp"
#include "common/hid/hid_link.hpp"
#include "common/messages.hpp"
#include "common/shared_values.hpp"
#include "common/stale_policy.hpp"
#include "common/time.hpp"
#include "cutaneous_node/drive_settings.hpp"
#include "cutaneous_node/touchdiver/touchdiver_settings.hpp"

namespace thimble {

enum class FingertipDevice : std::uint8_t { kSimulated, kBoard, kDrives, kTouchDiver };

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
    TouchDiverSettings touchdiver{};
    // Of the force in HF, what the handle gives: 1, but with [control] compensator = "scaled". The rest is for the skin.
    double hand_share = 1;

    // A trial of this kind presses fingers, of the hand that holds the handle or of the other one.
    bool presses(Modality modality) const {
        return modality == Modality::kCF || modality == Modality::kCCF ||
               (modality == Modality::kHF && hand_share < 1);
    }
};

CutaneousSettings read_cutaneous_settings(const ConfigTable& table);

}  // namespace thimble
