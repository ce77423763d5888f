#include "master/devices/handle_settings.hpp"

#include <array>
#include <string_view>

#include "master/devices/remote_handle.hpp"

namespace thimble {
namespace {

constexpr std::size_t kSha256Digits = 64;

// Frame and stiffness end where the device does: stiffest_N_per_m is what its maker, or practice, recommends at most.
void read_axis(const ConfigTable& table, AxisSettings& axis, double stiffest_N_per_m) {
    std::size_t chosen = 2 * axis.axis + (axis.sign < 0 ? 1 : 0);
    table.read("axis", chosen, {"+x", "-x", "+y", "-y", "+z", "-z"},
               "The device's direction into the tissue (docs/handles.md).");
    axis.axis = chosen / 2;
    axis.sign = chosen % 2 == 0 ? 1 : -1;
    table.read("origin_m", axis.origin_m, -0.5, 0.5,
               "Along that axis: where the hand's z is 0, outside the tissue.");
    table.read("lateral", axis.lateral, {"clamps", "virtual"}, "Who holds the device beside its axis.");
    table.read("lateral_stiffness_N_per_m", axis.lateral_stiffness_N_per_m, 0, stiffest_N_per_m,
               "virtual: of the spring to the axis.");
    table.read("lateral_damping_Ns_per_m", axis.lateral_damping_Ns_per_m, 0, 20, "virtual: beside it.");
    table.read("lateral_force_limit_N", axis.lateral_force_limit_N, 0, 20, "virtual: at most.");
}

ForceDimensionSettings read_force_dimension(const ConfigTable& table) {
    ForceDimensionSettings settings;
    read_axis(table, settings.axis, 5000);
    table.read("library", settings.library, "The file of Force Dimension's SDK; empty: it is sought.");
    table.read("serial", settings.serial, 0, 65535, "The number on the base; 0: the only one.");
    table.read("stop_button", settings.stop_button, -1, 15,
               "Which button is an emergency stop, by the SDK's number; -1: none.");
    table.read("gravity_compensation", settings.gravity_compensation, "The SDK carries the device's weight.");
    table.read("watchdog", settings.watchdog, "Refuse a device whose watchdog cannot be set.");
    return settings;
}

FalconSettings read_falcon(const ConfigTable& table) {
    static constexpr std::array<std::uint8_t, 6> kButtons{
        kFalconAnyButton, 0, kFalconPlus, kFalconForward, kFalconCentre, kFalconMinus};
    FalconSettings settings;
    read_axis(table, settings.axis, 3000);
    table.read("serial", settings.serial, "The USB serial number; empty: the only one.");
    table.read("firmware", settings.firmware, "A file; empty: the device must have been loaded already.");
    table.read("firmware_sha256", settings.firmware_sha256, "64 hexadecimal digits; needed with a file.");
    table.read("motor_gain_per_Nm", settings.motor_gain_per_Nm, 1, 1e5,
               "Motor counts for each N m at a leg: a calibration.");
    std::size_t button = 0;
    table.read("stop_button", button, {"any", "none", "plus", "forward", "centre", "minus"},
               "Which button at the grip is an emergency stop.");
    settings.stop_buttons = kButtons[button];
    table.read("homing_limit_s", settings.homing_limit, 0.1, 600, "For the user, before the node is ready.");
    const std::string_view digits = settings.firmware_sha256;
    const bool hexadecimal = digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
    if (!digits.empty() && (digits.size() != kSha256Digits || !hexadecimal))
        table.fail("firmware_sha256", "64 digits 0-9, a-f, as sha256sum prints them");
    if (!settings.firmware.empty() && digits.empty())
        table.fail("firmware",
                   "also needs firmware_sha256 (sha256sum prints it): what runs in the device moves a hand");
    return settings;
}

}  // namespace

Duration user_limit(const HandleSettings& settings) {
    if (settings.kind == HandleKind::kRos2) return kRos2DriverLimit;
    return settings.kind == HandleKind::kFalcon ? settings.falcon.homing_limit : Duration::zero();
}

HandleSettings read_handle_settings(const ConfigTable& table) {
    HandleSettings settings;
    table.read("device", settings.kind,
               {"simulated", "pointer", "keyboard", "hid", "force-dimension", "falcon", "ros2"},
               "Who moves the handle, or which real one it is (docs/handles.md); in virtual time the first.");
    table.read("encoder_resolution_m", settings.encoder_resolution_m, 1e-9, 1e-3, "Of the hand's position.");
    table.read("force_limit_N", settings.force_limit_N, 0.1, 100, "Of the device, both ways.");
    table.read("moving_mass_kg", settings.mechanics.moving_mass_kg, 0.02, 5, "Felt along z.");
    table.read("damping_Ns_per_m", settings.mechanics.damping_Ns_per_m, 0, 50, "Of the mechanism.");
    table.read("friction_N", settings.mechanics.friction_N, 0, 5, "Dahl friction.");
    table.read("friction_travel_m", settings.mechanics.friction_travel_m, 1e-6, 1e-3, "Its presliding.");
    // Within what the lightest handle bears in steps of 0.1 ms.
    table.read("coupling_stiffness_N_per_m", settings.coupling.stiffness_N_per_m, 1, 10000,
               "pointer, keyboard, hid: from the pointer's place to the handle.");
    table.read("coupling_damping_Ns_per_m", settings.coupling.damping_Ns_per_m, 0, 100,
               "pointer, keyboard, hid: on the handle, also once it is let go.");
    table.read("coupling_force_limit_N", settings.coupling.force_limit_N, 0.1, 100,
               "pointer, keyboard, hid: the most that the hand pulls with; less than force_limit_N.");
    settings.force_dimension = read_force_dimension(table.table("force_dimension"));
    settings.falcon = read_falcon(table.table("falcon"));
    settings.hid = read_hid_hand_settings(table.table("hid"));
    read_ros2_handle_settings(table.table("ros2"));
    return settings;
}

}  // namespace thimble
