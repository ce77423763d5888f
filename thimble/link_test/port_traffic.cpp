#include "thimble/link_test/port_traffic.hpp"

#include <algorithm>

#include "common/codec.hpp"
#include "common/node_process.hpp"

namespace thimble {
namespace {

constexpr double kSamples_Hz = 1000;  // of the handle
constexpr double kFrames_Hz = 60;     // of the screen
constexpr double kBeeps_Hz = 50;      // five at once, 20 ms apart
constexpr double kStops_Hz = 20;      // from each program that stops, until released
constexpr double kMonitor_Hz = 250;
// A heartbeat ten times a second, and a clock probe or its reply five times.
constexpr double kControl_Hz = 1e9 / static_cast<double>(kHeartbeatPeriod.count()) + 5;

constexpr std::array<const char*, kPortCount> kPortNames{"session_master",
                                                         "session_slave_sim",
                                                         "session_cutaneous",
                                                         "session_visual",
                                                         "session_netem",
                                                         "session_record",
                                                         "master_control",
                                                         "slave_sim_control",
                                                         "cutaneous_control",
                                                         "visual_control",
                                                         "netem_control",
                                                         "master_force",
                                                         "master_percept_cutaneous",
                                                         "master_percept_visual",
                                                         "slave_sim_needle",
                                                         "cutaneous_force",
                                                         "visual_force",
                                                         "visual_beep",
                                                         "netem_needle",
                                                         "netem_force_master",
                                                         "netem_force_cutaneous",
                                                         "netem_force_visual",
                                                         "master_hand",
                                                         "session_orders",
                                                         "experimenter_monitor",
                                                         "session_player_orders",
                                                         "player_monitor",
                                                         "session_stop",
                                                         "master_stop",
                                                         "slave_sim_stop",
                                                         "cutaneous_stop",
                                                         "visual_stop",
                                                         "netem_stop"};

PortTraffic traffic_of(Port port, Encoder& encoder) {
    const Header header;
    const auto sized = [&](const auto& body, double rate_Hz, bool haptic) {
        return PortTraffic{port, encoder.encode(header, body).size(), rate_Hz, haptic};
    };
    switch (port) {
        case Port::kSlaveNeedle:
        case Port::kNetemNeedle:
            return sized(NeedleCommand{}, kSamples_Hz, true);
        case Port::kSessionRecord:
        case Port::kMasterForce:
        case Port::kCutaneousForce:
        case Port::kVisualForce:
        case Port::kNetemForceMaster:
        case Port::kNetemForceCutaneous:
        case Port::kNetemForceVisual:
            return sized(ForceFeedback{}, kSamples_Hz, true);
        case Port::kMasterPerceptCutaneous:
            return sized(Percept{}, kSamples_Hz, true);
        case Port::kMasterPerceptVisual:
            return sized(Percept{}, kFrames_Hz, false);
        case Port::kVisualBeep:
            return sized(SessionControl{}, kBeeps_Hz, false);
        case Port::kMasterHand:
            return sized(HandInput{}, kSamples_Hz, true);
        case Port::kSessionOrders:
        case Port::kSessionPlayerOrders:
            return sized(Order{}, kBeeps_Hz, false);
        case Port::kExperimenterMonitor:
        case Port::kPlayerMonitor:
            return sized(Monitor{}, kMonitor_Hz, false);
        case Port::kSessionStop:
        case Port::kMasterStop:
        case Port::kSlaveStop:
        case Port::kCutaneousStop:
        case Port::kVisualStop:
        case Port::kNetemStop:
            return sized(StopOrder{}, kStops_Hz, false);
        default:
            return sized(Heartbeat{}, kControl_Hz,
                         false);  // the longest of what control channels carry often
    }
}

}  // namespace

std::array<PortTraffic, kPortCount> session_traffic() {
    Encoder encoder;
    std::array<PortTraffic, kPortCount> traffic;
    for (const Port port : kEveryPort) traffic[static_cast<std::size_t>(port)] = traffic_of(port, encoder);
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
    return index < kPortNames.size() ? kPortNames[index] : "none";
}

}  // namespace thimble
