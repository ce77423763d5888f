// Hosts and ports of a session: table [network] of its file. One base port per session; every flow has a fixed
// offset from it (docs/protocol.md draws them).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "common/messages.hpp"
#include "common/security/security_settings.hpp"

namespace thimble {

// Offsets from the base port. Append only.
enum class Port : std::uint16_t {
    // session's end of the control channels, one per node
    kSessionMaster,
    kSessionSlave,
    kSessionCutaneous,
    kSessionVisual,
    kSessionNetem,
    kSessionRecord,
    // nodes' ends of the control channels
    kMasterControl,
    kSlaveControl,
    kCutaneousControl,
    kVisualControl,
    kNetemControl,
    // data
    kMasterForce,
    kMasterPerceptCutaneous,
    kMasterPerceptVisual,
    kSlaveNeedle,
    kCutaneousForce,
    kVisualForce,
    kVisualScene,
    kNetemNeedle,
    kNetemForceMaster,
    kNetemForceCutaneous,
    kNetemForceVisual,
    // views and persons
    kMasterHand,
    kSessionOrders,
    kExperimenterMonitor,
    kSessionPlayerOrders,
    kPlayerMonitor,
    // stop buses: a program that stops everything sends to all of them (stop_bus.hpp)
    kSessionStop,
    kMasterStop,
    kSlaveStop,
    kCutaneousStop,
    kVisualStop,
    kNetemStop,
    kCount,
};
inline constexpr std::size_t kPortCount = static_cast<std::size_t>(Port::kCount);
// All of them, in order.
inline constexpr auto kEveryPort = [] {
    std::array<Port, kPortCount> ports{};
    for (std::size_t i = 0; i < kPortCount; ++i) ports[i] = static_cast<Port>(i);
    return ports;
}();

// The flow at a port: receiver, sender, content. docs/protocol.md has all of them.
struct Flow {
    Role listens = Role::kSession, hears = Role::kSession;
    const char* what = "";
    const char* topic = "";  // in a log (docs/log.md): the same at both ends and on both sides of the relay
    bool from_all = false;   // the machines of every role are heard, not only that of `hears`
};
const Flow& flow(Port port);
// The listening ports of the stop buses.
inline constexpr std::array kStopPorts{Port::kSessionStop,   Port::kMasterStop, Port::kSlaveStop,
                                       Port::kCutaneousStop, Port::kVisualStop, Port::kNetemStop};
// The program that listens at the port.
Role owner(Port port);
// True for the port of a view, whose address may change while the session runs (docs/security.md).
constexpr bool may_move(Port port) { return port == Port::kExperimenterMonitor; }
// Where a program of the session hears of stops. A view has no such port.
Port stop_port(Role role);

struct Endpoint {
    std::string host;
    std::uint16_t port = 0;
};
// Reads "9870" or "lab-pc:9870". `otherwise` is the host where the text names none. Nothing for any other text, or without a host.
std::optional<Endpoint> endpoint_in(const std::string& text, const std::string& otherwise);
// The same. Throws Error (usage) naming `option`.
Endpoint read_endpoint(const std::string& text, std::string_view option, const std::string& otherwise);

struct NetworkSettings {
    SecuritySettings security;  // table [security]
    // Below 32768, where Linux starts to hand out ports to sockets that ask for none.
    static constexpr std::uint16_t kDefaultBasePort = 27000;
    std::uint16_t base_port = kDefaultBasePort;
    std::array<std::string, kRoleCount> hosts = every_role_here();  // by Role

    // Names the rig for its key: [security] rig or all hosts, and the base port.
    std::string rig() const;
    const std::string& host(Role role) const { return hosts[static_cast<std::size_t>(role)]; }
    Endpoint at(Port port) const;

    static std::array<std::string, kRoleCount> every_role_here() {
        std::array<std::string, kRoleCount> hosts;
        hosts.fill("127.0.0.1");
        return hosts;
    }
};

// Tables [network] and [security].
NetworkSettings read_network_settings(const ConfigFile& file);

// Those of a program that only looks at a session: of no file where none is named; base_port of 0: the file's.
NetworkSettings observed_network(const std::string& session_file, std::uint16_t base_port);

// The tables that a session file may hold. A program checks its own and leaves the rest to the others.
std::vector<std::string_view> session_tables();

}  // namespace thimble
