#include "cutaneous_node/drive_settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace thimble {
namespace {

struct FingerKey {
    const char* key;
    Hand hand;
    Finger finger;
    double first_node;
};
constexpr std::array kFingerKeys{FingerKey{"acting_index", Hand::kActing, Finger::kIndex, 1},
                                 FingerKey{"acting_thumb", Hand::kActing, Finger::kThumb, 4},
                                 FingerKey{"other_index", Hand::kOther, Finger::kIndex, 7},
                                 FingerKey{"other_thumb", Hand::kOther, Finger::kThumb, 10}};

void read_finger(const ConfigTable& table, const FingerKey& finger, DriveSettings& settings) {
    const double first = finger.first_node;
    const auto nodes = table.numbers(finger.key, {first, first + 1, first + 2}, 1, 126);
    if (nodes.empty()) return;
    if (nodes.size() != kCablesPerFinger) table.fail(finger.key, "must hold three node ids, or none");
    settings.fingers.push_back({finger.hand, finger.finger, settings.master.nodes.size()});
    for (const double node : nodes) {
        const auto id = static_cast<std::uint8_t>(node);
        if (id != node) table.fail(finger.key, "must hold whole numbers");
        const auto& before = settings.master.nodes;
        if (std::find(before.begin(), before.end(), id) != before.end()) {
            table.fail(finger.key, fmt::format("holds {}, which another cable has", id));
        }
        settings.master.nodes.push_back(id);
    }
}

void read_bus(const ConfigTable& table, DriveSettings& settings) {
    constexpr std::string_view kPrefix = "cannelloni:";
    constexpr std::size_t kLongestInterface = 15;  // IFNAMSIZ - 1
    settings.bus = table.text("bus", "");
    const auto listen = static_cast<std::uint16_t>(table.integer("listen_port", 20000, 1024, 65535));
    if (settings.bus.compare(0, kPrefix.size(), kPrefix) != 0) {
        if (settings.bus.size() > kLongestInterface) {
            table.fail("bus", "must be the name of a CAN interface, or \"cannelloni:HOST:PORT\"");
        }
        return;
    }
    const std::string rest = settings.bus.substr(kPrefix.size());
    const auto colon = rest.rfind(':');
    std::uint16_t port = 0;
    if (colon != std::string::npos) std::from_chars(rest.data() + colon + 1, rest.data() + rest.size(), port);
    if (colon == std::string::npos || colon == 0 ||
        rest != fmt::format("{}:{}", rest.substr(0, colon), port) || port == 0) {
        table.fail("bus", "must be \"cannelloni:HOST:PORT\", e.g. \"cannelloni:192.168.1.7:20000\"");
    }
    settings.cannelloni = CannelloniAddress{rest.substr(0, colon), port, listen};
}

void read_cable(const ConfigTable& table, DriveSettings& settings) {
    CableDrive& cable = settings.cable;
    settings.cable_angle_rad = table.number("cable_angle_rad", settings.cable_angle_rad, 0.01, 1.5);
    cable.pulley_radius_m = table.number("pulley_radius_m", cable.pulley_radius_m, 1e-4, 0.1);
    cable.gear_ratio = table.number("gear_ratio", cable.gear_ratio, 0.1, 10000);
    cable.efficiency = table.number("efficiency", cable.efficiency, 0.05, 1);
    cable.counts_per_turn = table.number("counts_per_turn", cable.counts_per_turn, 1, 1e8);
    cable.reversed = table.boolean("reversed", cable.reversed);
    settings.rated_torque_unit_Nm =
        table.number("rated_torque_unit_Nm", settings.rated_torque_unit_Nm, 1e-9, 1);
    settings.pretension_N = table.number("pretension_N", settings.pretension_N, 0.001, 5);
    settings.deadband_N = table.number("deadband_N", settings.deadband_N, 0, 5);
    settings.slack_margin_m = table.number("slack_margin_m", settings.slack_margin_m, 1e-4, 0.1);
    settings.pad.scale_N = table.number("pad_scale_N", settings.pad.scale_N, 0.001, 10);
    settings.pad.exponent_per_m = table.number("pad_exponent_per_m", settings.pad.exponent_per_m, 10, 1e5);
}

}  // namespace

DriveSettings read_drive_settings(const ConfigTable& table) {
    using std::chrono::microseconds;
    using std::chrono::milliseconds;
    using std::chrono::seconds;
    DriveSettings settings;
    CanMasterSettings& master = settings.master;
    read_bus(table, settings);
    const bool position = table.choice("mode", 0, {"torque", "position"}) == 1;
    master.mode = position ? DriveMode::kSyncPosition : DriveMode::kSyncTorque;
    master.cycle = table.seconds("cycle_s", master.cycle, microseconds{500}, milliseconds{100});
    if (position && !interpolation_time(master.cycle))
        table.fail("cycle_s",
                   "must with mode = \"position\" be what object 0x60C2 can say, e.g. 0.004 or 0.0025");
    master.silent_after = table.seconds("silent_after_s", master.silent_after, milliseconds{4}, seconds{10});
    if (master.silent_after < 4 * master.cycle)
        table.fail("silent_after_s", "must be four times cycle_s at least");
    for (const FingerKey& finger : kFingerKeys) read_finger(table, finger, settings);
    if (settings.fingers.empty())
        table.fail("acting_index", "and the other three are empty: name a device's nodes");
    settings.take_up_limit =
        table.seconds("take_up_limit_s", settings.take_up_limit, milliseconds{200}, seconds{60});
    read_cable(table, settings);
    return settings;
}

std::string drive_name(const DriveSettings& settings, std::size_t drive) {
    for (const FingerDevice& finger : settings.fingers) {
        if (drive < finger.first || drive >= finger.first + kCablesPerFinger) continue;
        return fmt::format("drive {} ({} hand, {}, cable {})", settings.master.nodes[drive],
                           finger.hand == Hand::kActing ? "acting" : "other",
                           finger.finger == Finger::kIndex ? "index" : "thumb", drive - finger.first);
    }
    return "the drives";
}

}  // namespace thimble
