// Which packets arrive with flipped bits, and which bits: as many as asked, all different, each of the packet's bits
// equally likely.
#pragma once

#include <cstdint>
#include <span>

#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Corrupt {
  public:
    static constexpr unsigned kMostBits = 64;

    Corrupt(const StreamKey& key, std::uint32_t direction)
        : numbers_(link_key(key, direction, Purpose::kLinkCorrupt)),
          bits_stream_(link_key(key, direction, Purpose::kLinkCorruptBits)) {}

    // bits: 1 to kMostBits; of a packet that has fewer, all.
    void configure(double probability, unsigned bits);
    bool hits(std::uint64_t packet) { return probability_ > 0 && numbers_.uniform(packet) < probability_; }
    void flip(std::uint64_t packet, std::span<std::uint8_t> bytes);

  private:
    PacketNumbers numbers_;
    RandomStream bits_stream_;
    double probability_ = 0;
    unsigned bits_ = 1;
};

}  // namespace thimble
