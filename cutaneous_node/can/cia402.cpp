#include "cutaneous_node/can/cia402.hpp"

#include <array>
#include <cstddef>

namespace thimble {

namespace {

constexpr std::uint16_t kVoltage = 1U << 4U, kRemote = 1U << 9U, kFollows = 1U << 12U;

// `mask` and `bits` tell the state from a statusword, `statusword` is what a drive says, `next` leads towards operation.
struct StateRow {
    const char* name;
    std::uint16_t mask, bits, statusword, next;
};
// By DriveState.
constexpr std::array<StateRow, 8> kStates{{
    {"not ready", 0x4f, 0x00, 0, kControlDisableVoltage},
    {"switch-on disabled", 0x4f, 0x40, 0x40 | kRemote, kControlShutdown},
    {"ready to switch on", 0x6f, 0x21, 0x21 | kRemote, kControlSwitchOn},
    {"switched on", 0x6f, 0x23, 0x23 | kVoltage | kRemote, kControlEnable},
    {"operation enabled", 0x6f, 0x27, 0x27 | kVoltage | kRemote | kFollows, kControlEnable},
    {"quick stop", 0x6f, 0x07, 0x07 | kVoltage | kRemote, kControlDisableVoltage},
    {"fault reaction", 0x4f, 0x0f, 0x0f | kVoltage | kRemote, kControlDisableVoltage},
    {"fault", 0x4f, 0x08, 0x08 | kRemote, kControlFaultReset},
}};

const StateRow& row_of(DriveState state) { return kStates[static_cast<std::size_t>(state)]; }

}  // namespace

const char* to_string(DriveState state) { return row_of(state).name; }

DriveState state_of(std::uint16_t statusword) {
    for (std::size_t i = 0; i < kStates.size(); ++i) {
        if ((statusword & kStates[i].mask) == kStates[i].bits) return static_cast<DriveState>(i);
    }
    return DriveState::kNotReady;
}

std::uint16_t control_towards_operation(DriveState state) { return row_of(state).next; }

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

std::uint16_t DriveAutomaton::statusword() const { return row_of(state_).statusword; }

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
