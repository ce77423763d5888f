#include "cutaneous_node/can/cia402.hpp"

#include <array>
#include <cstddef>

namespace thimble {

const char* to_string(DriveState state) {
    static constexpr std::array kNames{
        "not ready",         "switch-on disabled", "ready to switch on", "switched on",
        "operation enabled", "quick stop",         "fault reaction",     "fault"};
    return kNames[static_cast<std::size_t>(state)];
}

DriveState state_of(std::uint16_t statusword) {
    switch (statusword & 0x4fU) {
        case 0x40:
            return DriveState::kSwitchOnDisabled;
        case 0x0f:
            return DriveState::kFaultReaction;
        case 0x08:
            return DriveState::kFault;
        default:
            break;
    }
    switch (statusword & 0x6fU) {
        case 0x21:
            return DriveState::kReadyToSwitchOn;
        case 0x23:
            return DriveState::kSwitchedOn;
        case 0x27:
            return DriveState::kOperationEnabled;
        case 0x07:
            return DriveState::kQuickStop;
        default:
            return DriveState::kNotReady;
    }
}

std::uint16_t control_towards_operation(DriveState state) {
    switch (state) {
        case DriveState::kFault:
            return kControlFaultReset;
        case DriveState::kSwitchOnDisabled:
            return kControlShutdown;
        case DriveState::kReadyToSwitchOn:
            return kControlSwitchOn;
        case DriveState::kSwitchedOn:
        case DriveState::kOperationEnabled:
            return kControlEnable;
        default:
            return kControlDisableVoltage;
    }
}

std::optional<InterpolationTime> interpolation_time(Duration cycle) {
    Duration unit = std::chrono::milliseconds{1};
    for (std::int8_t exponent = -3; exponent >= -9; --exponent, unit /= 10) {
        if (cycle % unit != Duration::zero()) continue;
        const std::int64_t count = cycle / unit;
        if (count < 1 || count > 255) return std::nullopt;
        return InterpolationTime{static_cast<std::uint8_t>(count), exponent};
    }
    return std::nullopt;
}

std::uint16_t DriveAutomaton::statusword() const {
    constexpr std::uint16_t kVoltage = 1U << 4U, kRemote = 1U << 9U, kFollows = 1U << 12U;
    switch (state_) {
        case DriveState::kNotReady:
            return 0;
        case DriveState::kSwitchOnDisabled:
            return 0x40 | kRemote;
        case DriveState::kReadyToSwitchOn:
            return 0x21 | kRemote;
        case DriveState::kSwitchedOn:
            return 0x23 | kVoltage | kRemote;
        case DriveState::kOperationEnabled:
            return 0x27 | kVoltage | kRemote | kFollows;
        case DriveState::kQuickStop:
            return 0x07 | kVoltage | kRemote;
        case DriveState::kFaultReaction:
            return 0x0f | kVoltage | kRemote;
        case DriveState::kFault:
            return 0x08 | kRemote;
    }
    return 0;
}

void DriveAutomaton::obey(std::uint16_t controlword) {
    const bool reset = (controlword & kControlFaultReset) != 0 && (last_ & kControlFaultReset) == 0;
    last_ = controlword;
    if (state_ == DriveState::kFault) {
        if (reset) state_ = DriveState::kSwitchOnDisabled;  // 15
        return;
    }
    if (state_ == DriveState::kNotReady || state_ == DriveState::kFaultReaction) return;
    const std::uint16_t command = controlword & 0x0fU;
    const bool live = state_ == DriveState::kOperationEnabled || state_ == DriveState::kQuickStop;
    if ((command & 0x02U) == 0) {
        state_ = DriveState::kSwitchOnDisabled;  // 7, 9, 10, 12
    } else if ((command & 0x04U) == 0) {
        state_ = live ? DriveState::kQuickStop : DriveState::kSwitchOnDisabled;  // 11; 7, 10
    } else if ((command & 0x01U) == 0) {
        if (state_ != DriveState::kQuickStop) state_ = DriveState::kReadyToSwitchOn;  // 2, 6, 8
    } else if (state_ == DriveState::kReadyToSwitchOn) {
        state_ = DriveState::kSwitchedOn;  // 3; operation is one word later
    } else if (state_ == DriveState::kSwitchedOn || state_ == DriveState::kOperationEnabled) {
        state_ = command == kControlEnable ? DriveState::kOperationEnabled : DriveState::kSwitchedOn;  // 4, 5
    }
}

}  // namespace thimble
