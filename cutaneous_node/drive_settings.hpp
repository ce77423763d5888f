// The table [cutaneous.drives]: fingertip devices of three cables each, a motor drive per cable, all on one CAN bus. What is
// marked (a) is an assumption about devices of this kind and to be measured on yours.
//   bus = "can0"               an interface of SocketCAN, or "cannelloni:HOST:PORT", a bus elsewhere over UDP
//   listen_port = 20000        of cannelloni: where its datagrams come to
//   mode = "torque"            cyclic synchronous torque, or "position"
//   cycle_s = 0.004            of SYNC; 12 drives at 1 Mbit/s need 2.8 ms
//   silent_after_s = 0.1       silence of a drive, or of the master, that counts as lost
//   acting_index = [1, 2, 3]   node ids, cable 0 (at the fingertip) first; [] if nobody wears that one
//   acting_thumb = [4, 5, 6], other_index = [7, 8, 9], other_thumb = [10, 11, 12]
//   cable_angle_rad = 0.35     (a) of a cable to the normal of the pad
//   pulley_radius_m = 0.0025, gear_ratio = 16, efficiency = 0.8, counts_per_turn = 64   (a)
//   reversed = false           a positive torque slackens
//   rated_torque_unit_Nm = 1e-6  (a) of object 0x6076
//   pretension_N = 0.03        (a) of each cable, always
//   deadband_N = 0.02          a smaller force is none
//   take_up_limit_s = 3        until all cables are taut
//   slack_margin_m = 0.003     (a) drawn in beyond what the pad gives way to: slack
//   pad_scale_N = 0.1, pad_exponent_per_m = 700   (a) pad_model.hpp
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "common/messages.hpp"
#include "cutaneous_node/can/master_settings.hpp"
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
};

DriveSettings read_drive_settings(const ConfigTable& table);

// "drive 5 (acting hand, thumb, cable 1)", by its index in master.nodes.
std::string drive_name(const DriveSettings& settings, std::size_t drive);

}  // namespace thimble
