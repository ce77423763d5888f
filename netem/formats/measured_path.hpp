// One direction of a path as it was measured, packet by packet: importers give it, `fit` takes it. trace_files.hpp
// reads and writes it as CSV.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace thimble {

struct MeasuredPacket {
    std::int64_t at = 0;              // sent, in nanoseconds since the first; or its number, see MeasuredPath
    std::optional<Duration> delay{};  // one way; none if it was lost
    double loss = 0;                  // 0 received, 1 lost; between them where a file gives a probability
    double bits_per_s = 0;            // above 0 where a file has a rate

    bool operator==(const MeasuredPacket&) const = default;
};

struct MeasuredPath {
    std::vector<MeasuredPacket> packets;
    bool by_packet = false;  // `at` counts packets instead of nanoseconds
    bool has_delay = false, has_loss = false, has_rate = false;
    std::vector<std::string> remarks;  // about clocks, guesses and what was left out, a sentence each

    // Its time is moved behind that of the packet before: stamps may be equal, or jitter by more than the interval.
    void append(MeasuredPacket packet) {
        if (!packets.empty()) packet.at = std::max(packet.at, packets.back().at + 1);
        packets.push_back(packet);
    }
    bool operator==(const MeasuredPath&) const = default;
};

// Largest and longest values that any file may hold.
inline constexpr std::size_t kMostPackets = 5'000'000;  // an hour at 1 kHz is 3.6 million
inline constexpr Duration kLongestPathDelay = std::chrono::seconds{60};
inline constexpr Duration kLongestPath = std::chrono::hours{1000};

}  // namespace thimble
