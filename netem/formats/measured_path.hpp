// One direction of a path as it was measured, packet by packet: what importers give, what `fit` takes, and the CSV
// between them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"

namespace thimble {

struct MeasuredPacket {
    std::int64_t at = 0;            // sent, in nanoseconds since the first; or its number, see MeasuredPath
    std::optional<Duration> delay;  // one way; none if it was lost
    double loss = 0;                // 0 received, 1 lost; between them where a file gives a probability
    double bits_per_s = 0;          // above 0 where a file has a rate

    bool operator==(const MeasuredPacket&) const = default;
};

struct MeasuredPath {
    std::vector<MeasuredPacket> packets;
    bool by_packet = false;  // `at` counts packets instead of nanoseconds
    bool has_delay = false, has_loss = false, has_rate = false;
    std::vector<std::string> remarks;  // about clocks, guesses and what was left out, a sentence each

    bool operator==(const MeasuredPath&) const = default;
};

// As CSV, columns time_s (or packet), delay_s, loss, rate_bits_per_s, as far as there are such values. Remarks stand
// in front as comments. To the nanosecond; empty where a packet has no delay.
std::string print_path(const MeasuredPath& path);

// Largest and longest values that any file may hold.
inline constexpr std::size_t kMostPackets = 5'000'000;  // an hour at 1 kHz is 3.6 million
inline constexpr Duration kLongestPathDelay = std::chrono::seconds{60};
inline constexpr Duration kLongestPath = std::chrono::hours{1000};

}  // namespace thimble
