// Measures of a link, port by port.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "session/clocks/clock_summary.hpp"
#include "thimble/link_test/port_finding.hpp"
#include "thimble/link_test/port_traffic.hpp"

namespace thimble {

struct PortFigures {
    PortTraffic traffic;
    PortAnswer answer = PortAnswer::kSilent;
    std::uint32_t sent = 0;     // probes that the kernel took
    std::uint32_t refused = 0;  // that it did not
    // As the far side counted. `counted`: it told after all probes had been sent, not only in the last echo.
    bool counted = false;
    std::uint32_t far_received = 0, far_duplicates = 0, far_reordered = 0, far_sent = 0;
    std::uint32_t returned = 0, duplicates = 0, reordered = 0;  // echoes, as they came here
    double round_trip_median_s = 0, round_trip_p99_s = 0, round_trip_worst_s = 0;
    double longest_gap_s = 0;  // between two echoes
    double seconds_s = 0;      // of sending

    // Shares; 0 where nothing was sent.
    double loss_there() const;
    double loss_back() const;
    double jitter_s() const { return round_trip_p99_s - round_trip_median_s; }
    double rate_there_Hz() const { return seconds_s > 0 ? far_received / seconds_s : 0; }
};

// The largest datagram (UDP payload) that came back with fragmentation forbidden both ways.
struct MtuFigures {
    std::size_t largest_bytes = 0;  // 0: not even the smallest
    bool limited_here = false;      // the kernel refused one byte more (EMSGSIZE): this machine's interface
    std::size_t mtu_bytes() const {
        return largest_bytes == 0 ? 0 : largest_bytes + 28;
    }  // IPv4 and UDP headers
};

struct LinkFigures {
    std::string host;
    unsigned base_port = 0;
    std::vector<PortFigures> ports;
    MtuFigures mtu;
    ClockSummary clock;
    std::uint32_t stalls = 0;  // of this machine: probes left out because it could not run for 50 ms

    bool all_answer() const;
    bool any_answers() const;
};

// The worst over the ports of the haptic loop that answer.
struct LoopFigures {
    bool measured = false;
    double round_trip_median_s = 0, round_trip_p99_s = 0;
    double loss = 0;  // there and back together
    double longest_gap_s = 0;
};
LoopFigures loop_figures(const LinkFigures& link);

}  // namespace thimble
