#include "netem/stages/corrupt.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace thimble {
namespace {

// At most kMostBits, and below() hardly ever takes a second one.
constexpr std::uint64_t kNumbersPerDamage = 128;

}  // namespace

void Corrupt::configure(double probability, unsigned bits) {
    assert(bits >= 1 && bits <= kMostBits);
    probability_ = probability;
    bits_ = bits;
}

// Floyd's sample without replacement (Bentley and Floyd 1987): for the last n places j in turn, a place up to j, or j
// itself if that was taken.
void Corrupt::flip(std::uint64_t packet, std::span<std::uint8_t> bytes) {
    const auto all = static_cast<std::uint32_t>(bytes.size() * 8);
    const std::uint32_t count = std::min<std::uint32_t>(bits_, all);
    std::array<std::uint32_t, kMostBits> taken{};
    bits_stream_.seek(kNumbersPerDamage * packet);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t last = all - count + i;
        const std::uint32_t drawn = bits_stream_.below(last + 1);
        const auto end = taken.begin() + i;
        const std::uint32_t bit = std::find(taken.begin(), end, drawn) == end ? drawn : last;
        taken[i] = bit;
        bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
    }
}

}  // namespace thimble
