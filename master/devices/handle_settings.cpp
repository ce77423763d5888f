#include "master/devices/handle_settings.hpp"

#include <array>
#include <string_view>

#include "common/ros2_settings.hpp"

namespace thimble {
namespace {

constexpr std::size_t kSha256Digits = 64;
// For a person to calibrate a device.
constexpr Duration kCalibrationLimit = std::chrono::seconds{60};

// Frame and stiffness end where the device does: stiffest_N_per_m is what its maker, or practice, recommends at most.
void read_axis(const ConfigTable& table, AxisSettings& axis, double stiffest_N_per_m) {
    std::size_t chosen = 2 * axis.axis + (axis.sign < 0 ? 1 : 0);
    table.read("axis", chosen, {"+x", "-x", "+y", "-y", "+z", "-z"},
               "Axis of the device that points into the tissue (docs/handles.md).");
    axis.axis = chosen / 2;
    axis.sign = chosen % 2 == 0 ? 1 : -1;
    table.read("origin_m", axis.origin_m, -0.5, 0.5,
               "Position along that axis where the hand's z is 0, outside the tissue.");
    table.read("lateral", axis.lateral, {"clamps", "virtual"},
               "Holds the device on its axis. clamps: mechanical clamps; virtual: a spring and a damper.");
    table.read("lateral_stiffness_N_per_m", axis.lateral_stiffness_N_per_m, 0, stiffest_N_per_m,
               "virtual: stiffness of the spring towards the axis.");
    table.read("lateral_damping_Ns_per_m", axis.lateral_damping_Ns_per_m, 0, 20,
               "virtual: damping beside the axis.");
    table.read("lateral_force_limit_N", axis.lateral_force_limit_N, 0, 20,
               "virtual: force limit beside the axis.");
    for (const char* key : {"lateral_stiffness_N_per_m", "lateral_damping_Ns_per_m", "lateral_force_limit_N"})
        if (table.has(key) && axis.lateral != LateralHold::kVirtual)
            table.fail(key, "has an effect with lateral = \"virtual\" only, and lateral is \"clamps\"");
}

ForceDimensionSettings read_force_dimension(const ConfigTable& table) {
    ForceDimensionSettings settings;
    read_axis(table, settings.axis, 5000);
    table.read("library", settings.library, "Library file of Force Dimension's SDK; empty: searched for.");
    table.read("serial", settings.serial, 0, 65535, "Serial number on the base; 0: the only device.");
    table.read("stop_button", settings.stop_button, -1, 15,
               "Button for the emergency stop, numbered as in the SDK; -1: none.");
    table.read("gravity_compensation", settings.gravity_compensation,
               "true: the SDK compensates the weight of the device.");
    table.read("watchdog", settings.watchdog, "true: refuse a device whose watchdog cannot be set.");
    return settings;
}

FalconSettings read_falcon(const ConfigTable& table) {
    static constexpr std::array<std::uint8_t, 6> kButtons{
        kFalconAnyButton, 0, kFalconPlus, kFalconForward, kFalconCentre, kFalconMinus};
    FalconSettings settings;
    read_axis(table, settings.axis, 3000);
    table.read("serial", settings.serial, "USB serial number; empty: the only device.");
    table.read("firmware", settings.firmware, "Firmware file; empty: the device must be loaded already.");
    table.read("firmware_sha256", settings.firmware_sha256,
               "SHA-256 of the firmware, 64 hexadecimal digits; needed with a file.");
    table.read("motor_gain_per_Nm", settings.motor_gain_per_Nm, 1, 1e5,
               "Motor counts per N m at a leg (calibration).");
    std::size_t button = 0;
    table.read("stop_button", button, {"any", "none", "plus", "forward", "centre", "minus"},
               "Button of the grip for the emergency stop.");
    settings.stop_buttons = kButtons[button];
    table.read("homing_limit_s", settings.homing_limit, 0.1, 600,
               "Time for the user to make the device ready, before the program is ready.");
    const std::string_view digits = settings.firmware_sha256;
    const bool hexadecimal = digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
    if (!digits.empty() && (digits.size() != kSha256Digits || !hexadecimal))
        table.fail("firmware_sha256", "64 digits 0-9, a-f, as sha256sum prints them");
    if (!settings.firmware.empty() && digits.empty())
        table.fail("firmware",
                   "needs firmware_sha256 as well (sha256sum prints it): this firmware moves a hand, so it "
                   "must be the right one");
    return settings;
}

HaplySettings read_haply(const ConfigTable& table) {
    HaplySettings settings;
    read_axis(table, settings.axis, 3000);
    table.read("port", settings.port, 1, 65535, "Port of Haply's Inverse Service on this machine.");
    table.read("device_id", settings.device_id,
               "Device id, as the service and the Haply Hub show it; empty: the only device.");
    table.read("force_key", settings.force_key, {"values", "vector"},
               "Name of a force in the service's messages; if no force comes, try the other one.");
    return settings;
}

TouchSettings read_touch(const ConfigTable& table) {
    TouchSettings settings;
    read_axis(table, settings.axis, 3000);
    table.read("library", settings.library, "Library file libHD.so of OpenHaptics; empty: searched for.");
    table.read("name", settings.name, "Name of the device in Touch_Setup; empty: the default device.");
    table.read("stop_button", settings.stop_button, 0, 4,
               "Button of the stylus for the emergency stop, numbered as in the library; 0: none.");
    return settings;
}

// Of a real handle, where a file has no value.
double usual_force_limit_N(HandleKind kind) {
    if (kind == HandleKind::kTouch) return kTouchForce_N;
    return kind == HandleKind::kHaply ? kHaplyForce_N : kHandleFullScale_N;
}

// A hand of the handle's own strength could hold down a late force.
void refuse_strong_hand(const ConfigTable& table, const HandleSettings& settings) {
    const bool coupled = held_by_person(settings.kind) && !is_real(settings.kind);
    if (!coupled || settings.coupling.force_limit_N < settings.force_limit_N) return;
    table.fail("coupling_force_limit_N",
               "is {:g}, but must be less than force_limit_N, {:g}: lower it, or raise force_limit_N",
               settings.coupling.force_limit_N, settings.force_limit_N);
}

}  // namespace

Duration user_limit(const HandleSettings& settings) {
    switch (settings.kind) {
        case HandleKind::kRos2:
            return kRos2DriverLimit;
        case HandleKind::kFalcon:
            return settings.falcon.homing_limit;
        case HandleKind::kHaply:
        case HandleKind::kTouch:
            return kCalibrationLimit;
        default:
            return Duration::zero();
    }
}

HandleSettings read_handle_settings(const ConfigTable& table, std::optional<HandleKind> instead) {
    HandleSettings settings;
    table.read(
        "device", settings.kind,
        {"simulated", "pointer", "keyboard", "hid", "force-dimension", "falcon", "ros2", "haply", "touch"},
        "Handle, and what moves it (docs/handles.md); in virtual time always simulated.");
    settings.kind = instead.value_or(settings.kind);
    settings.force_limit_N = usual_force_limit_N(settings.kind);
    table.read("encoder_resolution_m", settings.encoder_resolution_m, 1e-9, 1e-3,
               "Resolution of the hand's position.");
    table.read("force_limit_N", settings.force_limit_N, 0.1, 100,
               "Force limit of the device in both directions. Default for a Touch 3.3, for an Inverse3 3.");
    table.read("moving_mass_kg", settings.mechanics.moving_mass_kg, 0.02, 5, "Mass felt along z.");
    table.read("damping_Ns_per_m", settings.mechanics.damping_Ns_per_m, 0, 50,
               "Viscous damping of the mechanism.");
    table.read("friction_N", settings.mechanics.friction_N, 0, 5, "Dahl friction force.");
    table.read("friction_travel_m", settings.mechanics.friction_travel_m, 1e-6, 1e-3,
               "Presliding travel of the Dahl friction.");
    // Within what the lightest handle bears in steps of 0.1 ms.
    table.read("coupling_stiffness_N_per_m", settings.coupling.stiffness_N_per_m, 1, 10000,
               "pointer, keyboard, hid: stiffness between the pointer's position and the handle.");
    table.read("coupling_damping_Ns_per_m", settings.coupling.damping_Ns_per_m, 0, 100,
               "pointer, keyboard, hid: damping of the handle, also after it is released.");
    table.read("coupling_force_limit_N", settings.coupling.force_limit_N, 0.1, 100,
               "pointer, keyboard, hid: largest force of the hand; less than force_limit_N.");
    settings.force_dimension = read_force_dimension(table.table("force_dimension"));
    settings.falcon = read_falcon(table.table("falcon"));
    settings.haply = read_haply(table.table("haply"));
    settings.touch = read_touch(table.table("touch"));
    settings.hid = read_hid_hand_settings(table.table("hid"));
    read_ros2_settings(table.table("ros2"));
    refuse_strong_hand(table, settings);
    return settings;
}

}  // namespace thimble
