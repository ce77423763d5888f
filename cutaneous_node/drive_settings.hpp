// The table [cutaneous.drives]: fingertip devices of three cables each, a motor drive per cable, all on one CAN bus
// (docs/fingertip.md). (a) marks an assumption about devices of this kind, to be measured on yours.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "common/messages.hpp"
#include "cutaneous_node/can/cia402.hpp"
#include "cutaneous_node/fingertip/cable_command.hpp"
#include "cutaneous_node/fingertip/pad_model.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

struct CannelloniAddress {
    std::string host;
    std::uint16_t port = 0;
    std::uint16_t listen_port = 20000;
};

// One finger's device: its drives are master.nodes[first] and the next two.
struct FingerDevice {
    Hand hand = Hand::kActing;
    Finger finger = Finger::kIndex;
    std::size_t first = 0;
};

struct DriveSettings {
    std::string bus;                              // as written; empty: none
    std::optional<CannelloniAddress> cannelloni;  // else `bus` is an interface
    CanMasterSettings master;
    std::vector<FingerDevice> fingers;
    double cable_angle_rad = 0.35;
    CableDrive cable;
    double rated_torque_unit_Nm = 1e-6;
    double pretension_N = 0.03;
    double deadband_N = 0.02;
    Duration take_up_limit = std::chrono::seconds{3};
    double slack_margin_m = 0.003;
    PadParameters pad;

    // This finger has drives.
    bool worn(Hand hand, Finger finger) const {
        return std::any_of(fingers.begin(), fingers.end(), [&](const FingerDevice& device) {
            return device.hand == hand && device.finger == finger;
        });
    }
    // Pretension alone presses a finger with this force. It is no part of the felt force.
    double resting_N() const {
        return FingerGeometry(cable_angle_rad).normal_N({pretension_N, pretension_N, pretension_N});
    }
};

DriveSettings read_drive_settings(const ConfigTable& table);

// "drive 5 (acting hand, thumb, cable 1)", by its index in master.nodes.
std::string drive_name(const DriveSettings& settings, std::size_t drive);

}  // namespace thimble
