// Recorded traces: of delay and loss, and of deliveries.
#include <memory>

#include <gtest/gtest.h>

#include "netem/link_settings.hpp"
#include "netem/packet_trace.hpp"
#include "netem/stages/deliveries.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

std::vector<TraceRow> ramp() {
    return {{.at = 0, .delay = milliseconds{10}, .loss = 0},
            {.at = 10, .delay = milliseconds{20}, .loss = 0.5},
            {.at = 15, .delay = milliseconds{40}, .loss = 1}};
}

TEST(PacketTrace, HoldsOrInterpolates) {
    const PacketTrace hold(ramp(), {.between = TraceBetween::kHold});
    EXPECT_EQ(hold.at(0).delay, milliseconds{10});
    EXPECT_EQ(hold.at(9).delay, milliseconds{10});
    EXPECT_EQ(hold.at(10).delay, milliseconds{20});
    const PacketTrace linear(ramp(), {.between = TraceBetween::kLinear});
    EXPECT_EQ(linear.at(5).delay, milliseconds{15});
    EXPECT_DOUBLE_EQ(linear.at(5).loss, 0.25);
    EXPECT_EQ(linear.at(11).delay, milliseconds{24});
}

TEST(PacketTrace, WrapsOrHoldsItsEnd) {
    const PacketTrace wrap(ramp(), {.between = TraceBetween::kLinear});
    EXPECT_EQ(wrap.period(), 20);
    EXPECT_EQ(wrap.at(19).delay, milliseconds{16});  // back to the first row
    EXPECT_EQ(wrap.at(20).delay, milliseconds{10});
    EXPECT_EQ(wrap.at(20'000'005).delay, milliseconds{15});
    const PacketTrace hold(ramp(), {.between = TraceBetween::kLinear, .end = TraceEnd::kHold});
    EXPECT_EQ(hold.at(15).delay, milliseconds{40});
    EXPECT_EQ(hold.at(1'000'000).delay, milliseconds{40});
}

TEST(PacketTrace, HasTheMeansOfItsPeriod) {
    LinkSettings link{.delay = milliseconds{999}};
    link.loss = LossSettings::independent(1);
    EXPECT_EQ(mean_loss(link), 1);
    link.trace = std::make_shared<PacketTrace>(ramp(), TraceLayout{.has_loss = true});
    EXPECT_EQ(mean_delay(link), milliseconds{20});
    EXPECT_DOUBLE_EQ(mean_loss(link), 0.375);
    link.trace = std::make_shared<PacketTrace>(
        ramp(), TraceLayout{.between = TraceBetween::kLinear, .has_loss = true});
    EXPECT_EQ(mean_delay(link), std::chrono::microseconds{21'250});
    EXPECT_DOUBLE_EQ(mean_loss(link), 0.4375);
}

TEST(PacketTrace, NoPacketIsQuickerThanItsLeastDelay) {
    LinkSettings link{.delay = milliseconds{50}};
    EXPECT_EQ(least_delay(link), milliseconds{50});
    link.trace = std::make_shared<PacketTrace>(ramp(), TraceLayout{});
    EXPECT_EQ(least_delay(link), milliseconds{10});
    link.reorder = 0.1;
    EXPECT_EQ(least_delay(link), Duration{});
    link.reorder = 0;
    link.jitter = {JitterShape::kUniform, milliseconds{5}};
    EXPECT_EQ(least_delay(link), Duration{});
}

TEST(PacketTrace, BeforeTheFirstRowTheFirstHolds) {
    const PacketTrace trace({{.at = 7, .delay = milliseconds{1}}}, {});
    EXPECT_EQ(trace.at(0).delay, milliseconds{1});
    EXPECT_EQ(trace.at(8).delay, milliseconds{1});
}

// A single row has no neighbour that would tell how long it holds.
TEST(PacketTrace, ASingleRowHoldsForOnePacketOrOneSecond) {
    EXPECT_EQ(PacketTrace({{.at = 7}}, {.by = TraceBy::kPacket}).period(), 8);
    EXPECT_EQ(PacketTrace({{.at = 7}}, {}).period(), 1'000'000'007);
}

// By packet: each row is one packet's fate, and the trace replays it bit for bit.
TEST(PacketTrace, ReplaysDelayAndLossByPacket) {
    std::vector<TraceRow> rows;
    for (int i = 0; i < 5; ++i)
        rows.push_back({.at = i, .delay = milliseconds{10 + i}, .loss = i == 2 ? 1.0 : 0});
    LinkSettings settings{.delay = milliseconds{999}};
    settings.loss = LossSettings::independent(1);
    settings.in_order = false;
    settings.trace =
        std::make_shared<PacketTrace>(rows, TraceLayout{.by = TraceBy::kPacket, .has_loss = true});
    LinkModel link(settings, kKey, 0);
    const auto arrivals = transmit(link, 50, milliseconds{100});
    ASSERT_EQ(arrivals.size(), 40U);
    for (const Arrival& arrival : arrivals) {
        ASSERT_NE(arrival.packet % 5, 2U);
        ASSERT_EQ(arrival.time - at(arrival.packet * milliseconds{100}),
                  milliseconds{10 + arrival.packet % 5});
    }
    EXPECT_EQ(link.counters().lost, 10U);
}

// By time, from the start of the trial; jitter comes on top.
TEST(PacketTrace, FollowsDelayByTime) {
    LinkSettings settings;
    settings.jitter.shape = JitterShape::kUniform;
    settings.jitter.spread = milliseconds{2};
    settings.in_order = false;
    settings.trace =
        std::make_shared<PacketTrace>(std::vector<TraceRow>{{.at = 0, .delay = milliseconds{20}},
                                                            {.at = 1'000'000'000, .delay = milliseconds{60}}},
                                      TraceLayout{});
    LinkModel link(settings, kKey, 0);
    const SessionTime start = at(std::chrono::seconds{77});
    link.restart(kKey, start);
    bool varies = false;
    for (std::uint32_t i = 0; i < 4000; ++i) {
        const SessionTime now = start + i * kMillisecond;
        link.push(now, NumberedPacket(i).bytes());
        const Duration delay = link.next_due() - now;
        link.pop_due(link.next_due());
        const Duration mean = milliseconds{i / 1000 % 2 == 0 ? 20 : 60};
        ASSERT_LE(std::chrono::abs(delay - mean), milliseconds{2});
        varies = varies || delay != mean;
    }
    EXPECT_TRUE(varies);
}

// Recorded deliveries: mahimahi's rules, and the trace itself.
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
