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

TEST(Reorder, SkipsAsOftenAsAsked) {
    LinkModel link(overtaking(0.25, 2), kKey, 0);
    transmit(link, 20'000);
    EXPECT_NEAR(static_cast<double>(link.counters().skipped), 2500, 4 * std::sqrt(10'000 * 0.25 * 0.75));
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
