// Random numbers by packet number: what a stage draws for packet n depends on (key, direction, purpose, n) only,
// never on the time or on what became of other packets.
#pragma once

#include <cstdint>

#include "common/random.hpp"

namespace thimble {

// StreamKey has no field for the direction. An odd constant times a 32-bit number never repeats within 64 bits.
inline StreamKey link_key(const StreamKey& key, std::uint32_t direction, Purpose purpose) {
    StreamKey mixed = key;
    mixed.study ^= 0x9E3779B97F4A7C15U * (std::uint64_t{direction} + 1);
    mixed.purpose = purpose;
    return mixed;
}

// One number per packet; cheapest if no packet is left out.
class PacketNumbers {
  public:
    explicit PacketNumbers(const StreamKey& key) : stream_(key) {}

    double uniform(std::uint64_t packet) {
        if (packet != next_) stream_.seek(packet);
        next_ = packet + 1;
        return stream_.uniform();
    }
    // Standard normal. Takes a few numbers of the packets that follow.
    double normal(std::uint64_t packet) {
        stream_.seek(packet);
        next_ = UINT64_MAX;
        return stream_.normal();
    }

  private:
    RandomStream stream_;
    std::uint64_t next_ = 0;
};

// Which packets something happens to, each with the same probability.
class Chance {
  public:
    Chance(const StreamKey& key, std::uint32_t direction, Purpose purpose)
        : numbers_(link_key(key, direction, purpose)) {}

    void configure(double probability) { probability_ = probability; }
    bool hits(std::uint64_t packet) { return probability_ > 0 && numbers_.uniform(packet) < probability_; }

  private:
    PacketNumbers numbers_;
    double probability_ = 0;
};

}  // namespace thimble
