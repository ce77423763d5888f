#include "cutaneous_node/drive_settings.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "common/network_settings.hpp"

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
               "Node ids of the drives of the three cables, fingertip first; []: this device is not worn.");
    if (nodes.empty()) return;
    if (nodes.size() != kCablesPerFinger) table.fail(finger.key, "must hold three node ids, or none");
    settings.fingers.push_back({finger.hand, finger.finger, settings.master.nodes.size()});
    for (const double node : nodes) {
        const auto id = static_cast<std::uint8_t>(node);
        if (id != node) table.fail(finger.key, "must hold whole numbers");
        const auto& before = settings.master.nodes;
        if (std::find(before.begin(), before.end(), id) != before.end()) {
            table.fail(finger.key, "holds {}, which another cable has as well: each drive needs its own id",
                       id);
        }
        settings.master.nodes.push_back(id);
    }
}

void read_bus(const ConfigTable& table, DriveSettings& settings) {
    constexpr std::string_view kPrefix = "cannelloni:";
    constexpr std::size_t kLongestInterface = 15;  // IFNAMSIZ - 1
    CannelloniAddress address;
    table.read("bus", settings.bus,
               "Name of a CAN interface, or \"cannelloni:HOST:PORT\"; needed with device = \"drives\".");
    table.read("listen_port", address.listen_port, 1024, 65535,
               "cannelloni: UDP port for incoming datagrams.");
    if (settings.bus.compare(0, kPrefix.size(), kPrefix) != 0) {
        if (table.has("listen_port"))
            table.fail("listen_port", "has an effect with bus = \"cannelloni:HOST:PORT\" only: remove it");
        if (settings.bus.size() > kLongestInterface) {
            table.fail("bus", "must be the name of a CAN interface, or \"cannelloni:HOST:PORT\"");
        }
        return;
    }
    const auto far = endpoint_in(settings.bus.substr(kPrefix.size()), "");
    if (!far || far->port == 0)
        table.fail("bus", "must be \"cannelloni:HOST:PORT\", e.g. \"cannelloni:192.168.1.7:20000\"");
    address.host = far->host;
    address.port = far->port;
    settings.cannelloni = address;
}

void read_cable(const ConfigTable& table, DriveSettings& settings) {
    CableDrive& cable = settings.cable;
    table.read("cable_angle_rad", settings.cable_angle_rad, 0.01, 1.5,
               "Angle between a cable and the normal of the pad (a).");
    table.read("pulley_radius_m", cable.pulley_radius_m, 1e-4, 0.1, "Radius of the cable's pulley (a).");
    table.read("gear_ratio", cable.gear_ratio, 0.1, 10000, "Motor turns per pulley turn (a).");
    table.read("efficiency", cable.efficiency, 0.05, 1, "Efficiency from motor to cable (a).");
    table.read("counts_per_turn", cable.counts_per_turn, 1, 1e8, "Encoder counts per turn of the motor (a).");
    table.read("reversed", cable.reversed, "true: a positive torque slackens the cable.");
    table.read("rated_torque_unit_Nm", settings.rated_torque_unit_Nm, 1e-9, 1,
               "Unit of the rated torque, object 0x6076 (a).");
    table.read("pretension_N", settings.pretension_N, 0.001, 5,
               "Least tension of each cable, at all times (a).");
    table.read("deadband_N", settings.deadband_N, 0, 5, "Smaller forces count as zero.");
    table.read("take_up_limit_s", settings.take_up_limit, 0.2, 60, "Longest time until all cables are taut.");
    table.read("slack_margin_m", settings.slack_margin_m, 1e-4, 0.1,
               "Cable length beyond the pad's compliance that counts as slack (a).");
    table.read("pad_scale_N", settings.pad.scale_N, 0.001, 10,
               "Scale in F = scale (exp(exponent x) - 1) (a).");
    table.read("pad_exponent_per_m", settings.pad.exponent_per_m, 10, 1e5,
               "Exponent in F = scale (exp(exponent x) - 1) (a).");
}

}  // namespace

DriveSettings read_drive_settings(const ConfigTable& table) {
    DriveSettings settings;
    CanMasterSettings& master = settings.master;
    read_bus(table, settings);
    bool position = false;
    table.read("mode", position, {"torque", "position"},
               "torque: cyclic synchronous torque; position: cyclic synchronous position.");
    master.mode = position ? DriveMode::kSyncPosition : DriveMode::kSyncTorque;
    table.read("cycle_s", master.cycle, 0.0005, 0.1,
               "Time between two SYNC messages; 12 drives at 1 Mbit/s need 0.0028. With mode = \"position\" "
               "1 to 255 times a power of ten.");
    table.read("silent_after_s", master.silent_after, 0.004, 10,
               "A drive, or the master, that is silent for this time is lost; at least four cycles.");
    if (position && !interpolation_time(master.cycle))
        table.fail(
            "cycle_s",
            "must with mode = \"position\" be a value that object 0x60C2 can express, e.g. 0.004 or 0.0025");
    if (master.silent_after < 4 * master.cycle)
        table.fail("silent_after_s", "must be at least four times cycle_s");
    for (const FingerKey& finger : kFingerKeys) read_finger(table, finger, settings);
    if (settings.fingers.empty())
        table.fail("acting_index",
                   "is set, but the other three are empty: name the nodes of at least one device");
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
