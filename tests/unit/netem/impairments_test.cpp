// Packets that are corrupted, doubled or reordered.
#include <bit>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "netem/stages/corrupt.hpp"
#include "netem/stages/reorder.hpp"
#include "tests/unit/netem/link_test_tools.hpp"
#include "tests/unit/netem/statistics_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

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
        RC_ASSERT(flipped_bits(bytes, std::vector<std::uint8_t>(bytes.size())) ==
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

LinkSettings doubling(double probability) {
    LinkSettings settings{.delay = milliseconds{20}, .jitter = {JitterShape::kUniform, milliseconds{10}}};
    settings.duplicate = probability;
    settings.in_order = false;
    return settings;
}

TEST(Duplicate, DoublesAsOftenAsAsked) {
    LinkModel link(doubling(0.2), kKey, 0);
    std::map<std::uint32_t, int> copies;
    for (const Arrival& arrival : transmit(link, 20'000)) ++copies[arrival.packet];
    int twice = 0;
    for (const auto& [packet, count] : copies) {
        ASSERT_LE(count, 2);
        twice += count == 2;
    }
    EXPECT_EQ(copies.size(), 20'000U);
    EXPECT_NEAR(twice, 4000, 4 * std::sqrt(20'000 * 0.2 * 0.8));
    EXPECT_EQ(link.counters().duplicated, static_cast<std::uint64_t>(twice));
    EXPECT_EQ(link.counters().delivered, 20'000U + static_cast<std::uint64_t>(twice));
}

// Independent delays of one shape: as often the copy is first as the original.
TEST(Duplicate, CopiesHaveDelaysOfTheirOwn) {
    LinkModel link(doubling(1), kKey, 0);
    std::vector<double> originals, copies;
    int copy_first = 0;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        const SessionTime sent = at(i * milliseconds{100});
        link.push(sent, NumberedPacket(i).bytes());
        for (int k = 0; k < 2; ++k) {
            const SessionTime due = link.next_due();
            const Departure out = link.pop_departure(due);
            ASSERT_EQ(out.packet, i);
            (out.copy ? copies : originals).push_back(to_seconds(due - sent));
            copy_first += k == 0 && out.copy;
        }
    }
    const auto uniform = [](double delay_s) { return (delay_s - 0.010) / 0.020; };
    EXPECT_LT(ks_distance(originals, uniform), ks_limit(5000));
    EXPECT_LT(ks_distance(copies, uniform), ks_limit(5000));
    EXPECT_NEAR(copy_first, 2500, 4 * std::sqrt(1250.0));
}

TEST(Duplicate, LeavesTheFatesOfTheOriginalsAlone) {
    LinkModel plain(doubling(0), kKey, 0);
    LinkModel doubled(doubling(0.5), kKey, 0);
    std::map<std::uint32_t, SessionTime> expected;
    for (const Arrival& arrival : transmit(plain, 500)) expected[arrival.packet] = arrival.time;
    for (std::uint32_t i = 0; i < 500; ++i) doubled.push(at(i * kMillisecond), NumberedPacket(i).bytes());
    while (doubled.next_due() != kNever) {
        const SessionTime due = doubled.next_due();
        const Departure out = doubled.pop_departure(due);
        if (!out.copy) {
            ASSERT_EQ(due, expected.at(static_cast<std::uint32_t>(out.packet)));
        }
    }
}

LinkSettings overtaking(double probability, unsigned gap) {
    LinkSettings settings{.delay = milliseconds{10}};
    settings.reorder = probability;
    settings.reorder_gap = gap;
    settings.in_order = false;
    return settings;
}

TEST(Reorder, OnlyTheLastOfEachGroupSkipsTheDelay) {
    LinkModel link(overtaking(1, 5), kKey, 0);
    for (const Arrival& arrival : transmit(link, 1000)) {
        const Duration delay = arrival.time - at(arrival.packet * kMillisecond);
        ASSERT_EQ(delay, arrival.packet % 5 == 4 ? Duration::zero() : milliseconds{10}) << arrival.packet;
    }
    EXPECT_EQ(link.counters().skipped, 200U);
}

// From one skip to the next: gap - 1 packets, then trials with probability p until one succeeds.
TEST(Reorder, SkipsAsOftenAsTheKernel) {
    for (const unsigned gap : {1U, 2U, 5U}) {
        LinkModel link(overtaking(0.25, gap), kKey, 0);
        transmit(link, 20'000);
        const double mean = gap - 1 + 1 / 0.25, variance = 0.75 / (0.25 * 0.25);
        EXPECT_NEAR(static_cast<double>(link.counters().skipped), 20'000 / mean,
                    4 * std::sqrt(20'000 * variance / (mean * mean * mean)))
            << gap;
    }
}

// netem_enqueue() of Linux, with a generator of its own for each packet's number. A lost packet is not counted.
TEST(Reorder, SkipsThePacketsThatTheKernelSkips) {
    LinkSettings settings = overtaking(0.25, 5);
    settings.loss = LossSettings::independent(0.3);
    LinkFates fates(kKey, 0);
    fates.configure(settings, std::make_shared<const DelayShape>(settings.jitter, settings.delay));
    PacketNumbers numbers(link_key(kKey, 0, Purpose::kLinkReorder));
    unsigned counter = 0, skipped = 0, lost = 0;
    for (std::uint64_t packet = 0; packet < 5000; ++packet) {
        const PacketFate fate = fates.decide(packet, {});
        lost += fate.lost ? 1 : 0;
        if (fate.lost) continue;
        const bool delayed = counter < 5 - 1 || numbers.uniform(packet) >= 0.25;
        counter = delayed ? counter + 1 : 0;
        skipped += delayed ? 0 : 1;
        ASSERT_EQ(fate.skipped, !delayed) << packet;
    }
    EXPECT_GT(skipped, 300U);
    EXPECT_GT(lost, 1000U);
}

// Other settings begin a new count; the same ones go on with it.
TEST(Reorder, CountsAnewWithOtherSettings) {
    Reorder reorder(kKey, 0);
    const auto skips = [&](std::uint64_t from) {
        std::vector<bool> found;
        for (std::uint64_t packet = from; packet < from + 6; ++packet) found.push_back(reorder.skips(packet));
        return found;
    };
    reorder.configure(1, 4);
    EXPECT_EQ(skips(0), (std::vector<bool>{false, false, false, true, false, false}));
    reorder.configure(1, 4);
    EXPECT_EQ(skips(6), (std::vector<bool>{false, true, false, false, false, true}));
    reorder.configure(1, 3);
    EXPECT_EQ(skips(12), (std::vector<bool>{false, false, true, false, false, true}));
}

// At 1 kHz one that skips 10 ms comes before nine of those ahead of it, and with the tenth.
TEST(Reorder, CountsWhatComesAfterALaterOne) {
    LinkModel link(overtaking(1, 100), kKey, 0);
    transmit(link, 1000);
    EXPECT_EQ(link.counters().skipped, 10U);
    EXPECT_EQ(link.counters().reordered, 90U);
}

}  // namespace
}  // namespace thimble::test
