// Recorded deliveries: mahimahi's rules, and the trace itself.
#include "netem/stages/deliveries.hpp"

#include <gtest/gtest.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

Deliveries deliveries_of(std::vector<std::uint32_t> times_ms) {
    Deliveries deliveries;
    deliveries.configure(std::make_shared<const DeliveryTrace>(std::move(times_ms)));
    return deliveries;
}

TEST(DeliveryTrace, WrapsWithItsLastEntry) {
    const DeliveryTrace trace({0, 3, 3, 10});
    EXPECT_EQ(trace.period(), milliseconds{10});
    const int expected_ms[]{0, 3, 3, 10, 10, 13, 13, 20, 20};
    for (std::uint64_t i = 0; i < 9; ++i) EXPECT_EQ(trace.time_of(i), milliseconds{expected_ms[i]});
    EXPECT_DOUBLE_EQ(trace.mean_bits_per_s(), 4 * 12'000 / 0.010);
}

TEST(DeliveryTrace, FindsTheFirstOpportunityAfterATime) {
    for (const std::vector<std::uint32_t>& times :
         {std::vector<std::uint32_t>{0, 3, 3, 10}, {1}, {2, 2, 5, 5}}) {
        const DeliveryTrace trace(times);
        for (std::int64_t t_us = -100; t_us < 40'000; t_us += 100) {
            const Duration time = std::chrono::microseconds{t_us};
            std::uint64_t expected = 0;
            while (trace.time_of(expected) <= time) ++expected;
            ASSERT_EQ(trace.first_after(time), expected) << t_us;
        }
    }
}

TEST(Deliveries, EachMovesOnePacketOf1500Bytes) {
    Deliveries deliveries = deliveries_of({5, 6, 10});
    for (const int expected_ms : {5, 6, 10, 15, 16, 20}) {
        EXPECT_EQ(deliveries.opening({}), milliseconds{expected_ms});
        EXPECT_EQ(deliveries.take(1500), milliseconds{expected_ms});
    }
}

TEST(Deliveries, SmallPacketsShareOneAndLargeOnesTakeSeveral) {
    Deliveries deliveries = deliveries_of({10});
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(deliveries.opening({}), milliseconds{10});
        EXPECT_EQ(deliveries.take(400), milliseconds{10});
    }
    EXPECT_EQ(deliveries.opening({}), milliseconds{10});  // 300 bytes of room are left
    EXPECT_EQ(deliveries.take(400), milliseconds{20});
    EXPECT_EQ(deliveries.take(1400), milliseconds{20});
    EXPECT_EQ(deliveries.opening({}), milliseconds{30});
    EXPECT_EQ(deliveries.take(65'507), milliseconds{30 + 43 * 10});
}

TEST(Deliveries, WhatNobodyUsesIsLost) {
    Deliveries deliveries = deliveries_of({1, 2, 3, 4});
    EXPECT_EQ(deliveries.opening(milliseconds{2}), milliseconds{3});  // in its very instant is too late
    EXPECT_EQ(deliveries.take(100), milliseconds{3});
    EXPECT_EQ(deliveries.opening(milliseconds{3}), milliseconds{4});
    EXPECT_EQ(deliveries.opening(milliseconds{1'000'000}), milliseconds{1'000'001});
}

}  // namespace
}  // namespace thimble::test
