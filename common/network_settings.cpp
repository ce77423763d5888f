#include "common/network_settings.hpp"

namespace thimble {

Role owner(Port port) {
    if (port <= Port::kSessionRecord) return Role::kSession;
    switch (port) {
        case Port::kMasterControl:
        case Port::kMasterForce:
        case Port::kMasterPerceptCutaneous:
        case Port::kMasterPerceptVisual:
            return Role::kMaster;
        case Port::kSlaveControl:
        case Port::kSlaveNeedle:
            return Role::kSlaveSim;
        case Port::kCutaneousControl:
        case Port::kCutaneousForce:
            return Role::kCutaneous;
        case Port::kVisualControl:
        case Port::kVisualForce:
        case Port::kVisualBeep:
            return Role::kVisual;
        default:
            return Role::kNetem;
    }
}

Endpoint NetworkSettings::at(Port port) const {
    return {hosts[static_cast<std::size_t>(owner(port))],
            static_cast<std::uint16_t>(base_port + static_cast<std::uint16_t>(port))};
}

NetworkSettings read_network_settings(const ConfigFile& file) {
    constexpr auto kPorts = static_cast<std::int64_t>(Port::kCount);
    const ConfigTable table = file.table("network");
    NetworkSettings settings;
    settings.base_port =
        static_cast<std::uint16_t>(table.integer("base_port", settings.base_port, 1024, 65536 - kPorts));
    for (std::size_t i = 0; i < settings.hosts.size(); ++i) {
        const std::string key = std::string("host_") + to_string(static_cast<Role>(i));
        settings.hosts[i] = table.text(key, settings.hosts[i]);
    }
    return settings;
}

std::vector<std::string_view> session_tables() {
    return {"network", "session", "trial",    "protocol",  "dataset", "tissue", "fixture", "slave_sim",
            "master",  "handle",  "operator", "cutaneous", "visual",  "netem",  "runtime"};
}

}  // namespace thimble
