// The same link in virtual time: what a perfect machine would have made of the same packets. With the relay's own seed
// it foretells every fate; with other seeds it says how much delays and losses differ by chance alone, whatever their
// correlation.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/random.hpp"
#include "netem/link_settings.hpp"
#include "netem/relay/packet_record.hpp"

namespace thimble {

struct TwinLink {
    LinkSettings settings;
    Timeline timeline{};
    StreamKey key;
    std::uint32_t direction = 0;
    SessionTime start{}, opened{};  // of the relay and of the flow
};

struct TwinOutcome {
    std::vector<double> delays_s;  // of packets that left, of the first copy that did
    std::uint64_t dropped = 0;     // packets whose first copy did not leave
    std::vector<bool> dropped_packet;
};

// `received`: when each packet came, not decreasing; all of `bytes` bytes.
TwinOutcome replay(const TwinLink& link, std::span<const SessionTime> received, std::size_t bytes);

// Largest difference of two empirical distribution functions (Kolmogorov, Smirnov); sorts both. 1 if one is empty.
double ks_distance(std::vector<double>& a, std::vector<double>& b);

struct Comparison {
    bool spread = false;      // delays differ enough (50 us) for their distribution to say anything
    double distance = 0;      // KS of the achieved delays to twins
    double by_chance = 0;     // 95 % of twins are nearer to other twins than this
    double dropped_mean = 0;  // of twins

    double distance_ratio() const { return by_chance > 0 ? distance / by_chance : 0; }
};

// Against twins with 40 other seeds.
Comparison compare(const TwinLink& link, std::span<const SessionTime> received, std::size_t bytes,
                   std::vector<double> achieved_s);

}  // namespace thimble
