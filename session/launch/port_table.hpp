// Every UDP port of a session, who listens there and to whom: what a firewall must let through.
#pragma once

#include <string>

#include "common/network_settings.hpp"
#include "session/settings/launch_settings.hpp"

namespace thimble {

// A Markdown table, a line per port, in the order of Port. docs/machines.md holds the one of the defaults.
std::string port_table(const NetworkSettings& network);
// The flows from one machine to another, a line per port.
std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch);

}  // namespace thimble
