#include "common/network_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/decimal_text.hpp"
#include "common/error.hpp"

namespace thimble {

namespace {

// In the order of Port: who listens, to whom, for what, and its topic in a log.
constexpr std::array<Flow, kPortCount> kFlows{{
    {Role::kSession, Role::kMaster, "heartbeats", "/master/heartbeats"},
    {Role::kSession, Role::kSlaveSim, "heartbeats", "/slave_sim/heartbeats"},
    {Role::kSession, Role::kCutaneous, "heartbeats", "/cutaneous/heartbeats"},
    {Role::kSession, Role::kVisual, "heartbeats", "/visual/heartbeats"},
    {Role::kSession, Role::kNetem, "heartbeats", "/netem/heartbeats"},
    {Role::kSession, Role::kSlaveSim, "record", "/slave_sim/record"},
    {Role::kMaster, Role::kSession, "orders", "/session/orders/master"},
    {Role::kSlaveSim, Role::kSession, "orders", "/session/orders/slave_sim"},
    {Role::kCutaneous, Role::kSession, "orders", "/session/orders/cutaneous"},
    {Role::kVisual, Role::kSession, "orders", "/session/orders/visual"},
    {Role::kNetem, Role::kSession, "orders", "/session/orders/netem"},
    {Role::kMaster, Role::kNetem, "force", "/slave_sim/force_feedback/master"},
    {Role::kMaster, Role::kCutaneous, "percepts", "/cutaneous/percept"},
    {Role::kMaster, Role::kVisual, "percepts", "/visual/percept"},
    {Role::kSlaveSim, Role::kNetem, "needle", "/master/needle_command"},
    {Role::kCutaneous, Role::kNetem, "force", "/slave_sim/force_feedback/cutaneous"},
    {Role::kVisual, Role::kNetem, "force", "/slave_sim/force_feedback/visual"},
    {Role::kVisual, Role::kSlaveSim, "scene, beep", "/slave_sim/scene"},
    {Role::kNetem, Role::kMaster, "needle", "/master/needle_command"},
    {Role::kNetem, Role::kSlaveSim, "force for master", "/slave_sim/force_feedback/master"},
    {Role::kNetem, Role::kSlaveSim, "force for cutaneous", "/slave_sim/force_feedback/cutaneous"},
    {Role::kNetem, Role::kSlaveSim, "force for visual", "/slave_sim/force_feedback/visual"},
    {Role::kMaster, Role::kVisual, "hand", "/visual/hand_input"},
    {Role::kSession, Role::kExperimenter, "requests", "/experimenter/order"},
    {Role::kExperimenter, Role::kSession, "monitor", "/session/monitor/experimenter"},
    {Role::kSession, Role::kVisual, "player's requests", "/visual/order"},
    {Role::kVisual, Role::kSession, "player's monitor", "/session/monitor/player"},
    {Role::kSession, Role::kMaster, "stop, from everybody", "/stop/session", true},
    {Role::kMaster, Role::kSession, "stop, from everybody", "/stop/master", true},
    {Role::kSlaveSim, Role::kSession, "stop, from everybody", "/stop/slave_sim", true},
    {Role::kCutaneous, Role::kSession, "stop, from everybody", "/stop/cutaneous", true},
    {Role::kVisual, Role::kSession, "stop, from everybody", "/stop/visual", true},
    {Role::kNetem, Role::kSession, "stop, from everybody", "/stop/netem", true},
}};

}  // namespace

const Flow& flow(Port port) { return kFlows.at(static_cast<std::size_t>(port)); }

Role owner(Port port) { return flow(port).listens; }

Port stop_port(Role role) {
    std::size_t i = 0;
    while (owner(kStopPorts.at(i)) != role) ++i;
    return kStopPorts[i];
}

std::optional<Endpoint> endpoint_in(const std::string& text, const std::string& otherwise) {
    const std::size_t colon = text.rfind(':');
    const bool named = colon != std::string::npos;
    const std::string host = named ? text.substr(0, colon) : otherwise;
    const auto port = parse_whole<std::uint16_t>(std::string_view(text).substr(named ? colon + 1 : 0));
    if (!port || host.empty()) return std::nullopt;
    return Endpoint{host, *port};
}

Endpoint read_endpoint(const std::string& text, std::string_view option, const std::string& otherwise) {
    if (auto endpoint = endpoint_in(text, otherwise)) return *endpoint;
    throw Error(ExitCode::kUsage, "{}: '{}' is not PORT or HOST:PORT, with a port from 0 to 65535", option,
                text);
}

Endpoint NetworkSettings::at(Port port) const {
    return {host(owner(port)), static_cast<std::uint16_t>(base_port + static_cast<std::uint16_t>(port))};
}

std::string NetworkSettings::rig() const {
    if (!security.rig.empty()) return fmt::format("name {} {}", security.rig, base_port);
    return fmt::format("hosts {} {}", fmt::join(hosts, " "), base_port);
}

NetworkSettings read_network_settings(const ConfigFile& file) {
    constexpr auto kPorts = static_cast<std::int64_t>(Port::kCount);
    const ConfigTable table = file.table("network");
    NetworkSettings settings;
    settings.security = read_security_settings(file);
    table.read("base_port", settings.base_port, 1024, 65536 - kPorts,
               "First of 33 UDP ports (docs/protocol.md). Each further condition uses the next 33.");
    for (std::size_t i = 0; i < settings.hosts.size(); ++i) {
        const auto role = static_cast<Role>(i);
        table.read(fmt::format("host_{}", to_string(role)), settings.hosts[i],
                   role == owner(Port::kExperimenterMonitor)
                       ? "Name or address of the view at the start; with a key it may change later."
                       : "Name or address where this program listens; its datagrams are accepted from this "
                         "host only.");
    }
    return settings;
}

NetworkSettings observed_network(const std::string& session_file, std::uint16_t base_port) {
    const ConfigFile file = session_file.empty() ? ConfigFile::empty() : ConfigFile::load(session_file);
    NetworkSettings network;
    std::vector<std::string_view> elsewhere = session_tables();
    std::erase(elsewhere, "network");
    std::erase(elsewhere, "security");
    file.read_all([&] { network = read_network_settings(file); }, elsewhere);
    if (base_port != 0) network.base_port = base_port;
    return network;
}

std::vector<std::string_view> session_tables() {
    return {"network",   "security",     "session", "trial",    "protocol",  "dataset", "tissue", "fixture",
            "slave_sim", "master",       "handle",  "operator", "cutaneous", "visual",  "netem",  "runtime",
            "launch",    "instructions", "control", "log",      "guard",     "codec"};
}

}  // namespace thimble
