// The settings of a stand-alone relay.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
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

// The settings that hold `passed` after the start: the last change until then, or `first`.
inline const LinkSettings& link_at(const LinkSettings& first, const Timeline& timeline, Duration passed) {
    const auto next =
        std::upper_bound(timeline.begin(), timeline.end(), passed,
                         [](Duration time, const LinkChange& change) { return time < change.at; });
    return next == timeline.begin() ? first : std::prev(next)->settings;
}
inline LinkPair links_at(const LinkPair& first, const TimelinePair& timelines, Duration passed) {
    return {link_at(first.up, timelines.up, passed), link_at(first.down, timelines.down, passed)};
}

// A change by hand replaces those that have passed: they must not come back.
inline void forget_passed(TimelinePair& timelines, Duration passed) {
    for (Timeline* timeline : {&timelines.up, &timelines.down})
        std::erase_if(*timeline, [passed](const LinkChange& change) { return change.at <= passed; });
}

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
