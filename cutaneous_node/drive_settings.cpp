#include "cutaneous_node/drive_settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>

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
    std::vector<double> nodes{first, first + 1, first + 2};
    table.read(finger.key, nodes, 1, 126,
               "Node ids of the three cables, the one at the fingertip first; []: not worn.");
    if (nodes.empty()) return;
    if (nodes.size() != kCablesPerFinger) table.fail(finger.key, "must hold three node ids, or none");
    settings.fingers.push_back({finger.hand, finger.finger, settings.master.nodes.size()});
    for (const double node : nodes) {
        const auto id = static_cast<std::uint8_t>(node);
        if (id != node) table.fail(finger.key, "must hold whole numbers");
        const auto& before = settings.master.nodes;
        if (std::find(before.begin(), before.end(), id) != before.end()) {
            table.fail(finger.key, "holds {}, which another cable has: each drive has an id of its own", id);
        }
        settings.master.nodes.push_back(id);
    }
}

void read_bus(const ConfigTable& table, DriveSettings& settings) {
    constexpr std::string_view kPrefix = "cannelloni:";
    constexpr std::size_t kLongestInterface = 15;  // IFNAMSIZ - 1
    CannelloniAddress address;
    table.read("bus", settings.bus,
               "A CAN interface, or \"cannelloni:HOST:PORT\"; needed with device = \"drives\".");
    table.read("listen_port", address.listen_port, 1024, 65535,
               "Of cannelloni: where its datagrams come to.");
    if (settings.bus.compare(0, kPrefix.size(), kPrefix) != 0) {
        if (settings.bus.size() > kLongestInterface) {
            table.fail("bus", "must be the name of a CAN interface, or \"cannelloni:HOST:PORT\"");
        }
        return;
    }
    const std::string rest = settings.bus.substr(kPrefix.size());
    const auto colon = rest.rfind(':');
    std::uint16_t& port = address.port;
    if (colon != std::string::npos) std::from_chars(rest.data() + colon + 1, rest.data() + rest.size(), port);
    if (colon == std::string::npos || colon == 0 ||
        rest != fmt::format("{}:{}", rest.substr(0, colon), port) || port == 0) {
        table.fail("bus", "must be \"cannelloni:HOST:PORT\", e.g. \"cannelloni:192.168.1.7:20000\"");
    }
    address.host = rest.substr(0, colon);
    settings.cannelloni = address;
}

void read_cable(const ConfigTable& table, DriveSettings& settings) {
    CableDrive& cable = settings.cable;
    table.read("cable_angle_rad", settings.cable_angle_rad, 0.01, 1.5, "Of a cable to the pad's normal (a).");
    table.read("pulley_radius_m", cable.pulley_radius_m, 1e-4, 0.1, "Of the cable's pulley (a).");
    table.read("gear_ratio", cable.gear_ratio, 0.1, 10000, "Motor turns per pulley turn (a).");
    table.read("efficiency", cable.efficiency, 0.05, 1, "Motor to cable (a).");
    table.read("counts_per_turn", cable.counts_per_turn, 1, 1e8, "Of the motor (a).");
    table.read("reversed", cable.reversed, "A positive torque slackens.");
    table.read("rated_torque_unit_Nm", settings.rated_torque_unit_Nm, 1e-9, 1, "Of object 0x6076 (a).");
    table.read("pretension_N", settings.pretension_N, 0.001, 5, "Of each cable, always (a).");
    table.read("deadband_N", settings.deadband_N, 0, 5, "Less is no force.");
    table.read("take_up_limit_s", settings.take_up_limit, 0.2, 60, "Until all cables are taut.");
    table.read("slack_margin_m", settings.slack_margin_m, 1e-4, 0.1,
               "Drawn in beyond what the pad gives way to: slack (a).");
    table.read("pad_scale_N", settings.pad.scale_N, 0.001, 10, "F = scale (exp(exponent x) - 1) (a).");
    table.read("pad_exponent_per_m", settings.pad.exponent_per_m, 10, 1e5, "As above (a).");
}

}  // namespace

DriveSettings read_drive_settings(const ConfigTable& table) {
    DriveSettings settings;
    CanMasterSettings& master = settings.master;
    read_bus(table, settings);
    bool position = false;
    table.read("mode", position, {"torque", "position"}, "Cyclic synchronous, both.");
    master.mode = position ? DriveMode::kSyncPosition : DriveMode::kSyncTorque;
    table.read("cycle_s", master.cycle, 0.0005, 0.1,
               "Of SYNC; 12 drives at 1 Mbit/s need 0.0028; by position 1 to 255 times a power of ten.");
    table.read("silent_after_s", master.silent_after, 0.004, 10,
               "A drive, or the master, silent for so long is lost; four cycles at least.");
    if (position && !interpolation_time(master.cycle))
        table.fail("cycle_s",
                   "must with mode = \"position\" be what object 0x60C2 can say, e.g. 0.004 or 0.0025");
    if (master.silent_after < 4 * master.cycle)
        table.fail("silent_after_s", "must be four times cycle_s at least");
    for (const FingerKey& finger : kFingerKeys) read_finger(table, finger, settings);
    if (settings.fingers.empty())
        table.fail("acting_index", "and the other three are empty: name a device's nodes");
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
