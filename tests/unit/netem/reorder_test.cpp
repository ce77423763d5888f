#include "netem/stages/reorder.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

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
