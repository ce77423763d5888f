// One node's clock, computed from all exchanges of a session.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "session/clocks/clock_exchange.hpp"
#include "session/clocks/clock_file.hpp"

namespace thimble {

// A one-way delay: surely within value +- bound.
struct OneWayDelay {
    double median_s = 0;
    double bound_s = 0;
    bool known() const { return bound_s < median_s; }
};

struct ClockSummary {
    std::uint64_t exchanges = 0;
    std::uint64_t steps = 0;                 // what follows is of the exchanges since the last one
    std::optional<OffsetInterval> offset;    // at the last exchange; none without exchanges
    bool even = false;                       // a straight line passes through all bounds
    double rate_low = 0, rate_high = 0;      // seconds per second; if even
    std::optional<OneWayDelay> there, back;  // if even
    double round_trip_median_s = 0;

    bool rate_known() const;  // narrower than what any two clocks may do
};

// In the order in which they were answered.
ClockSummary summarize_clock(std::span<const ClockExchange> exchanges);

struct NodeClock {
    double delay_s = 0;  // of the condition
    Role node = Role::kMaster;
    ClockSummary summary;
};

// A summary per node that has exchanges, in the order of their roles.
std::vector<NodeClock> clocks_of(double delay_s, const std::vector<ClockRecord>& records);

}  // namespace thimble
