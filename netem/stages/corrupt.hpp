// Which bits of a damaged packet are flipped: as many as asked, all different, each of the packet's bits equally likely.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <span>

#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Corrupt {
  public:
    static constexpr unsigned kMostBits = 64;

    Corrupt(const StreamKey& key, std::uint32_t direction)
        : stream_(link_key(key, direction, Purpose::kLinkCorruptBits)) {}

    // bits: 1 to kMostBits; of a packet that has fewer, all.
    void configure(unsigned bits) {
        assert(bits >= 1 && bits <= kMostBits);
        bits_ = bits;
    }
    // Floyd's sample without replacement (Bentley and Floyd 1987): for the last n places j in turn, a place up to j, or j
    // itself if that was taken.
    void flip(std::uint64_t packet, std::span<std::uint8_t> bytes) {
        const auto all = static_cast<std::uint32_t>(bytes.size() * 8);
        const std::uint32_t count = std::min<std::uint32_t>(bits_, all);
        std::array<std::uint32_t, kMostBits> taken{};
        stream_.seek(kNumbersPerDamage * packet);
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t last = all - count + i;
            const std::uint32_t drawn = stream_.below(last + 1);
            const auto end = taken.begin() + i;
            const std::uint32_t bit = std::find(taken.begin(), end, drawn) == end ? drawn : last;
            taken[i] = bit;
            bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
        }
    }

  private:
    // At most kMostBits, and below() hardly ever takes a second one.
    static constexpr std::uint64_t kNumbersPerDamage = 128;

    RandomStream stream_;
    unsigned bits_ = 1;
};

}  // namespace thimble
