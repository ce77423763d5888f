// The measures of a link, port by port, and the meaning of a port's silence or errors.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "session/clocks/clock_summary.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {

enum class PortAnswer : std::uint8_t { kAnswers, kNobodyListens, kNoRoute, kProhibited, kSilent };
const char* to_string(PortAnswer answer);

// Of one port, after a few hellos.
struct PortEvidence {
    std::uint32_t welcomes = 0;
    int error = 0;  // errno of the last failed send or of the last ICMP message about one; 0: none
    bool by_icmp = false;
    int icmp_code = 0;  // of "destination unreachable" (RFC 792, RFC 1812)
};

PortAnswer classify(const PortEvidence& evidence);

// One sentence about all ports: where the fault lies and what to do. Empty if every port answers.
std::string diagnose(std::span<const PortAnswer> ports, const std::string& host, unsigned base_port);

struct PortFigures {
    PortTraffic traffic;
    PortAnswer answer = PortAnswer::kSilent;
    std::uint32_t sent = 0;     // probes that the kernel took
    std::uint32_t refused = 0;  // that it did not
    // Counts of the far side. `counted`: reported after all probes were sent, not only in the last echo.
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

struct LinkTestPlan {
    std::string host;
    std::uint16_t base_port = 0;
    std::vector<Port> ports;
    Duration duration = std::chrono::seconds{5};  // of the traffic
    const std::atomic<bool>* stop = nullptr;
};

// The near side of a link test: probes every port, finds the largest datagram that passes, then sends a session's
// traffic and measures the echo. Throws Error: usage or network, if the host is unknown or there is no route to it.
LinkFigures test_link(const LinkTestPlan& plan);

}  // namespace thimble
