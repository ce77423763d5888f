#include "master/devices/handle_settings.hpp"

#include <array>
#include <string_view>

namespace thimble {
namespace {

constexpr std::size_t kSha256Digits = 64;

void read_number(const ConfigTable& table, const char* key, double& value, double low, double high) {
    value = table.number(key, value, low, high);
}

// Frame and stiffness end where the device does: stiffest_N_per_m is what its maker, or practice, recommends at most.
void read_axis(const ConfigTable& table, AxisSettings& axis, double stiffest_N_per_m) {
    const std::size_t chosen =
        table.choice("axis", 2 * axis.axis + (axis.sign < 0 ? 1 : 0), {"+x", "-x", "+y", "-y", "+z", "-z"});
    axis.axis = chosen / 2;
    axis.sign = chosen % 2 == 0 ? 1 : -1;
    read_number(table, "origin_m", axis.origin_m, -0.5, 0.5);
    axis.lateral = static_cast<LateralHold>(table.choice("lateral", 0, {"clamps", "virtual"}));
    read_number(table, "lateral_stiffness_N_per_m", axis.lateral_stiffness_N_per_m, 0, stiffest_N_per_m);
    read_number(table, "lateral_damping_Ns_per_m", axis.lateral_damping_Ns_per_m, 0, 20);
    read_number(table, "lateral_force_limit_N", axis.lateral_force_limit_N, 0, 20);
}

ForceDimensionSettings read_force_dimension(const ConfigTable& table) {
    ForceDimensionSettings settings;
    read_axis(table, settings.axis, 5000);
    settings.library = table.text("library", "");
    settings.serial = static_cast<int>(table.integer("serial", 0, 0, 65535));
    settings.stop_button = static_cast<int>(table.integer("stop_button", settings.stop_button, -1, 15));
    settings.gravity_compensation = table.boolean("gravity_compensation", settings.gravity_compensation);
    settings.watchdog = table.boolean("watchdog", settings.watchdog);
    return settings;
}

// As libnifalcon names the grip's buttons.
std::uint8_t read_falcon_stop(const ConfigTable& table) {
    static constexpr std::array<std::uint8_t, 6> kButtons{
        kFalconAnyButton, 0, kFalconPlus, kFalconForward, kFalconCentre, kFalconMinus};
    return kButtons[table.choice("stop_button", 0, {"any", "none", "plus", "forward", "centre", "minus"})];
}

FalconSettings read_falcon(const ConfigTable& table) {
    FalconSettings settings;
    read_axis(table, settings.axis, 3000);
    settings.serial = table.text("serial", "");
    settings.firmware = table.text("firmware", "");
    settings.firmware_sha256 = table.text("firmware_sha256", "");
    read_number(table, "motor_gain_per_Nm", settings.motor_gain_per_Nm, 1, 1e5);
    settings.stop_buttons = read_falcon_stop(table);
    settings.homing_limit = table.seconds("homing_limit_s", settings.homing_limit,
                                          std::chrono::milliseconds{100}, std::chrono::minutes{10});
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
    return settings.kind == HandleKind::kFalcon ? settings.falcon.homing_limit : Duration::zero();
}

HandleSettings read_handle_settings(const ConfigTable& table) {
    HandleSettings settings;
    const auto read = [&table](const char* key, double& value, double low, double high) {
        read_number(table, key, value, low, high);
    };
    read("encoder_resolution_m", settings.encoder_resolution_m, 1e-9, 1e-3);
    read("force_limit_N", settings.force_limit_N, 0.1, 100);
    read("moving_mass_kg", settings.mechanics.moving_mass_kg, 0.02, 5);
    read("damping_Ns_per_m", settings.mechanics.damping_Ns_per_m, 0, 50);
    read("friction_N", settings.mechanics.friction_N, 0, 5);
    read("friction_travel_m", settings.mechanics.friction_travel_m, 1e-6, 1e-3);
    settings.kind = static_cast<HandleKind>(
        table.choice("device", 0, {"simulated", "pointer", "hid", "force-dimension", "falcon"}));
    // Within what the lightest handle bears in steps of 0.1 ms.
    read("coupling_stiffness_N_per_m", settings.coupling.stiffness_N_per_m, 1, 10000);
    read("coupling_damping_Ns_per_m", settings.coupling.damping_Ns_per_m, 0, 100);
    settings.force_dimension = read_force_dimension(table.table("force_dimension"));
    settings.falcon = read_falcon(table.table("falcon"));
    settings.hid = read_hid_hand_settings(table.table("hid"));
    return settings;
}

}  // namespace thimble
