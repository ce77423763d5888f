#include "netem/stages/corrupt.hpp"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

int flipped_bits(Bytes out, Bytes in) {
    int count = 0;
    for (std::size_t i = 0; i < in.size(); ++i) count += std::popcount(static_cast<unsigned>(out[i] ^ in[i]));
    return count;
}

TEST(Corrupt, FlipsAsManyBitsAsAsked) {
    EXPECT_TRUE(rc::check("distinct bits, or all there are", [] {
        Corrupt corrupt(kKey, 0);
        const unsigned bits = *rc::gen::inRange(1U, Corrupt::kMostBits + 1);
        corrupt.configure(bits);
        std::vector<std::uint8_t> bytes(*rc::gen::inRange<std::size_t>(1, 40), 0);
        corrupt.flip(*rc::gen::arbitrary<std::uint32_t>(), bytes);
        const std::vector<std::uint8_t> zeros(bytes.size(), 0);
        RC_ASSERT(flipped_bits(bytes, zeros) ==
                  static_cast<int>(std::min<std::size_t>(bits, 8 * bytes.size())));
    }));
}

TEST(Corrupt, EachBitIsAsLikely) {
    Corrupt corrupt(kKey, 0);
    corrupt.configure(3);
    std::array<int, 32> hits{};
    constexpr int kPackets = 20'000;
    for (std::uint64_t packet = 0; packet < kPackets; ++packet) {
        std::array<std::uint8_t, 4> bytes{};
        corrupt.flip(packet, bytes);
        for (std::size_t bit = 0; bit < 32; ++bit) hits[bit] += (bytes[bit / 8] >> (bit % 8)) & 1;
    }
    const double share = 3.0 / 32;
    for (const int count : hits) {
        EXPECT_NEAR(count, kPackets * share, 4.5 * std::sqrt(kPackets * share * (1 - share)));
    }
}

TEST(Corrupt, HitsAsOftenAsAskedAndBothCopiesAlike) {
    LinkSettings settings;
    settings.corrupt = 0.3;
    settings.corrupt_bits = 2;
    settings.duplicate = 0.5;
    LinkModel link(settings, kKey, 0);
    std::uint64_t hit = 0;
    for (std::uint32_t i = 0; i < 10'000; ++i) {
        const NumberedPacket packet(i);
        link.push(at(i * kMillisecond), packet.bytes());
        std::vector<std::uint8_t> first;
        while (link.next_due() != kNever) {
            const Departure out = link.pop_departure(at(i * kMillisecond));
            ASSERT_EQ(flipped_bits(out.bytes, packet.bytes()), out.corrupted ? 2 : 0);
            if (out.copy) {
                ASSERT_TRUE(std::equal(first.begin(), first.end(), out.bytes.begin()));
            }
            if (!out.copy) first.assign(out.bytes.begin(), out.bytes.end());
            hit += out.corrupted && !out.copy ? 1 : 0;
        }
    }
    EXPECT_NEAR(static_cast<double>(hit), 3000, 4 * std::sqrt(10'000 * 0.3 * 0.7));
    EXPECT_EQ(link.counters().corrupted, hit);
}

}  // namespace
}  // namespace thimble::test
