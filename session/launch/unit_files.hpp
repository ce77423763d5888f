// systemd units for laboratories whose nodes run as services and are steered with `thimble run --attach`
// (systemd.exec(5) explains each line).
#pragma once

#include <string>
#include <vector>

#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "session/settings/launch_settings.hpp"

namespace thimble {

struct UnitFile {
    std::string machine;  // empty: this one
    std::string name;     // "thimble-master.service"
    std::string text;
};

struct UnitPlan {
    LaunchSettings launch;
    NetworkSettings network;
    RuntimeSettings runtime;
    std::string session;  // name of the session file, which stands in /etc/thimble there
};

inline constexpr const char* kUnitFolder = "/etc/systemd/system";
inline constexpr const char* kSessionFolder = "/etc/thimble";

// One per node. Throws Error (usage) in mode "user-key".
std::vector<UnitFile> unit_files(const UnitPlan& plan);

// A Markdown table of the flows from one machine to another, a line per UDP port: a firewall must let them through.
std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch);

}  // namespace thimble
