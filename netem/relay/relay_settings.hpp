// The settings of a stand-alone relay.
#pragma once

#include <cstdint>
#include <vector>

#include "common/runtime/udp_socket.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

// Up: client to server. Down: what the server answers.
struct LinkPair {
    LinkSettings up, down;
    bool operator==(const LinkPair&) const = default;
};

// Planned changes, counted from the start of the relay.
struct TimelinePair {
    Timeline up, down;
};

struct RelayInlet {
    UdpAddress listen, to;
};

struct RelaySettings {
    std::vector<RelayInlet> inlets;
    LinkPair links;
    TimelinePair timelines;
    std::uint64_t seed = 1;
    std::size_t most_flows = 1000;
    Duration idle = std::chrono::seconds{60};  // a flow without packets for so long is forgotten
    bool precise = false;                      // spin before due times; needs SCHED_FIFO
};

}  // namespace thimble
