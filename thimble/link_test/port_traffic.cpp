#include <algorithm>

#include "common/codec.hpp"
#include "common/node_process.hpp"
#include "common/security/flow_roles.hpp"
#include "common/security/sealing.hpp"
#include "common/security/stop_seal.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {
namespace {

enum class Traffic : std::uint8_t {
    kControl,
    kNeedle,
    kForce,
    kTouch,
    kSight,
    kHand,
    kOrders,
    kMonitor,
    kStop
};

struct PortRow {
    const char* name;
    Traffic traffic;
};

// As docs/protocol.md lists them.
constexpr std::array<PortRow, kPortCount> kPortRows{{
    {"session_master", Traffic::kControl},
    {"session_slave_sim", Traffic::kControl},
    {"session_cutaneous", Traffic::kControl},
    {"session_visual", Traffic::kControl},
    {"session_netem", Traffic::kControl},
    {"session_record", Traffic::kForce},
    {"master_control", Traffic::kControl},
    {"slave_sim_control", Traffic::kControl},
    {"cutaneous_control", Traffic::kControl},
    {"visual_control", Traffic::kControl},
    {"netem_control", Traffic::kControl},
    {"master_force", Traffic::kForce},
    {"master_percept_cutaneous", Traffic::kTouch},
    {"master_percept_visual", Traffic::kSight},
    {"slave_sim_needle", Traffic::kNeedle},
    {"cutaneous_force", Traffic::kForce},
    {"visual_force", Traffic::kForce},
    {"visual_scene", Traffic::kForce},
    {"netem_needle", Traffic::kNeedle},
    {"netem_force_master", Traffic::kForce},
    {"netem_force_cutaneous", Traffic::kForce},
    {"netem_force_visual", Traffic::kForce},
    {"master_hand", Traffic::kHand},
    {"session_orders", Traffic::kOrders},
    {"experimenter_monitor", Traffic::kMonitor},
    {"session_player_orders", Traffic::kOrders},
    {"player_monitor", Traffic::kMonitor},
    {"session_stop", Traffic::kStop},
    {"master_stop", Traffic::kStop},
    {"slave_sim_stop", Traffic::kStop},
    {"cutaneous_stop", Traffic::kStop},
    {"visual_stop", Traffic::kStop},
    {"netem_stop", Traffic::kStop},
}};

// Between machines every datagram is sealed; on its way through netem twice (docs/security.md).
std::size_t seal_bytes(Port port, Traffic traffic) {
    if (traffic == Traffic::kStop) return StopSeal::kHeaderBytes + StopSeal::kCodeBytes;
    return ends_hop(port) ? 2 * kSealOverheadBytes : kSealOverheadBytes;
}

}  // namespace

std::array<PortTraffic, kPortCount> session_traffic() {
    Encoder encoder;
    const auto of = [&](const auto& body, double rate_Hz, bool haptic = false) {
        return PortTraffic{Port::kCount, encoder.encode(Header{}, body).size(), rate_Hz, haptic};
    };
    constexpr double kSamples_Hz = 1000;  // of the handle
    // A heartbeat, the longest of what control channels carry often, ten times a second; a clock probe or its reply five times.
    constexpr double kControl_Hz = 1e9 / static_cast<double>(kHeartbeatPeriod.count()) + 5;
    const std::array kinds{
        of(Heartbeat{}, kControl_Hz),
        of(NeedleCommand{}, kSamples_Hz, true),
        of(ForceFeedback{}, kSamples_Hz, true),
        of(Percept{}, kSamples_Hz, true),
        of(Percept{}, 60),  // frames of the screen
        of(HandInput{}, kSamples_Hz, true),
        of(Order{}, 50),
        of(Monitor{}, 250),
        of(StopOrder{}, 20),  // from each program that stops, until released
    };
    std::array<PortTraffic, kPortCount> traffic;
    for (std::size_t i = 0; i < kPortCount; ++i) {
        traffic[i] = kinds.at(static_cast<std::size_t>(kPortRows[i].traffic));
        traffic[i].port = static_cast<Port>(i);
        traffic[i].bytes += seal_bytes(traffic[i].port, kPortRows[i].traffic);
    }
    return traffic;
}

std::vector<Port> ports_on(const NetworkSettings& network, const std::string& host) {
    const bool named = std::find(network.hosts.begin(), network.hosts.end(), host) != network.hosts.end();
    std::vector<Port> ports;
    for (const Port port : kEveryPort) {
        if (!named || network.host(owner(port)) == host) ports.push_back(port);
    }
    return ports;
}

const char* to_string(Port port) {
    const auto index = static_cast<std::size_t>(port);
    return index < kPortRows.size() ? kPortRows[index].name : "none";
}

}  // namespace thimble
