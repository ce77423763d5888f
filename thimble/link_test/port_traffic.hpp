// A session's traffic at each of its UDP ports: sizes from the codec, rates from docs/protocol.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/network_settings.hpp"

namespace thimble {

struct PortTraffic {
    Port port = Port::kCount;
    std::size_t bytes = 0;  // of one datagram
    double rate_Hz = 0;     // while a trial runs
    bool haptic = false;    // part of the loop at the rate of the handle's samples
};

// All ports, by offset.
std::array<PortTraffic, kPortCount> session_traffic();
// Those that the programs on `host` listen at; all if no role of [network] is there.
std::vector<Port> ports_on(const NetworkSettings& network, const std::string& host);
// "slave_needle", as in the list of ports of docs/protocol.md.
const char* to_string(Port port);

}  // namespace thimble
