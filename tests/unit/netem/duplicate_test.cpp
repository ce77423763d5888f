// Packets that arrive twice.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "tests/unit/netem/link_test_tools.hpp"
#include "tests/unit/netem/statistics_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

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

}  // namespace
}  // namespace thimble::test
