// Rate and queue, through a whole link: when packets leave, who is dropped.
#include "netem/stages/transmitter.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "netem/packet_trace.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// A packet of 200 bytes takes a millisecond.
LinkSettings slow(std::size_t queue_packets = 0, Drop drop = Drop::kTail) {
    LinkSettings settings{.delay = milliseconds{5}};
    settings.rate = {.bits_per_s = 1.6e6, .queue_packets = queue_packets, .drop = drop};
    return settings;
}

TEST(Transmitter, CountsTheOverheadOfEachPacket) {
    LinkSettings settings = slow();
    settings.rate.overhead_bytes = 50;
    LinkModel link(settings, kKey, 0);
    link.push(at({}), NumberedPacket(0).bytes());
    EXPECT_EQ(link.next_due(), at(milliseconds{5} + microseconds{1250}));
}

struct Drops final : LinkObserver {
    std::vector<std::uint64_t> packets;
    DropReason reason{};
    void on_drop(std::uint64_t packet, SessionTime, std::size_t, DropReason why) override {
        packets.push_back(packet);
        reason = why;
    }
};

// As the kernel counts: 200 bytes and 20 of overhead are three cells of 100, each with 5 more.
TEST(Transmitter, SendsWholeCells) {
    LinkSettings settings;
    settings.rate = {.bits_per_s = 8e3, .overhead_bytes = 20, .cell_bytes = 100, .cell_overhead_bytes = 5};
    LinkModel link(settings, kKey, 0);
    link.push(SessionTime{}, NumberedPacket(0, 200).bytes());
    EXPECT_EQ(link.next_due(), SessionTime{std::chrono::milliseconds{315}});
    EXPECT_FALSE(link.pop_due(link.next_due()).empty());
    const SessionTime then{std::chrono::seconds{1}};
    link.push(then, NumberedPacket(1, 180).bytes());
    EXPECT_EQ(link.next_due(), then + std::chrono::milliseconds{210});
}

TEST(Transmitter, DropsTheNewestOrTheOldestThatWaits) {
    for (const Drop drop : {Drop::kTail, Drop::kHead}) {
        LinkModel link(slow(2, drop), kKey, 0);
        Drops drops;
        link.observe(&drops);
        for (std::uint32_t i = 0; i < 6; ++i) link.push(at({}), NumberedPacket(i).bytes());
        std::vector<std::uint32_t> left;
        while (link.next_due() != kNever) {
            for (Bytes out = link.pop_due(link.next_due()); !out.empty();) {
                left.push_back(number_of(out));
                out = {};
            }
        }
        const bool tail = drop == Drop::kTail;
        EXPECT_EQ(left, (tail ? std::vector<std::uint32_t>{0, 1, 2} : std::vector<std::uint32_t>{0, 4, 5}));
        EXPECT_EQ(drops.packets,
                  (tail ? std::vector<std::uint64_t>{3, 4, 5} : std::vector<std::uint64_t>{1, 2, 3}));
        EXPECT_EQ(drops.reason, DropReason::kQueueFull);
        EXPECT_EQ(link.counters().queue_full, 3U);
    }
}

TEST(Transmitter, MemoryOfDroppedPacketsIsUsedAgain) {
    LinkModel link(slow(2, Drop::kHead), kKey, 0);
    for (std::uint32_t i = 0; i < 10; ++i) link.push(at({}), NumberedPacket(i).bytes());
    const std::size_t once = link.memory_bytes();
    for (std::uint32_t i = 0; i < 1000; ++i) link.push(at({}), NumberedPacket(i).bytes());
    EXPECT_EQ(link.memory_bytes(), once);
}

// A packet takes 1,000,000.4 ns. Times are whole nanoseconds, and what rounding leaves goes to the next packet without a pause.
TEST(Transmitter, RoundingsDoNotAddUpAndEndWithAPause) {
    LinkSettings settings = slow();
    settings.delay = {};
    settings.rate.bits_per_s = 1600 / 1.0000004e-3;
    LinkModel busy(settings, kKey, 0);
    for (std::uint32_t i = 0; i < 50; ++i) busy.push(at({}), NumberedPacket(i).bytes());
    std::vector<Arrival> arrivals;
    drain(busy, at(milliseconds{100}), arrivals);
    EXPECT_EQ(arrivals.at(49).time, at(50 * milliseconds{1} + Duration{20}));
    LinkModel idle(settings, kKey, 0);
    const auto apart = transmit(idle, 2, milliseconds{10});
    EXPECT_EQ(apart.at(1).time, at(milliseconds{11}));
}

TEST(Transmitter, LimitsTheQueueInBytes) {
    for (const Drop drop : {Drop::kTail, Drop::kHead}) {
        LinkSettings settings = slow(0, drop);
        settings.rate.queue_bytes = 500;
        LinkModel link(settings, kKey, 0);
        link.push(at({}), NumberedPacket(0).bytes());
        link.push(at({}), NumberedPacket(1, 300).bytes());
        link.push(at({}), NumberedPacket(2, 200).bytes());
        EXPECT_EQ(link.counters().queue_full, 0U);
        link.push(at({}), NumberedPacket(3, 10).bytes());
        EXPECT_EQ(link.counters().queue_full, 1U);
        EXPECT_EQ(link.in_flight(), 3U);
        link.push(at({}), NumberedPacket(4, 501).bytes());  // never fits: no packet makes room for it
        EXPECT_EQ(link.counters().queue_full, 2U);
        EXPECT_EQ(link.in_flight(), 3U);
    }
}

TEST(Transmitter, TakesItsRateFromATrace) {
    LinkSettings settings{.delay = {}};
    settings.trace = std::make_shared<PacketTrace>(
        std::vector<TraceRow>{{.at = 0, .bits_per_s = 1.6e6}, {.at = 10'000'000, .bits_per_s = 3.2e6}},
        TraceLayout{.end = TraceEnd::kHold, .has_delay = false, .has_rate = true});
    LinkModel link(settings, kKey, 0);
    const auto arrivals = transmit(link, 40, microseconds{100});
    EXPECT_EQ(arrivals[9].time, at(milliseconds{10}));
    EXPECT_EQ(arrivals[10].time, at(milliseconds{10} + microseconds{500}));
    EXPECT_EQ(arrivals[39].time, at(milliseconds{25}));
}

// Against the plainest model of a queue: times by hand, one packet after the other.
TEST(Transmitter, AgreesWithTheArithmeticOfAQueue) {
    EXPECT_TRUE(rc::check("same packets at the same times", [] {
        const auto limit = *rc::gen::inRange<std::size_t>(1, 6);
        LinkModel link(slow(limit), kKey, 0);
        std::vector<Arrival> expected, arrivals;
        std::vector<SessionTime> starts;
        SessionTime now{}, free_at{};
        for (std::uint32_t i = 0; i < 60; ++i) {
            now += Duration{*rc::gen::inRange(0, 2'500'000)};
            const auto size = *rc::gen::inRange<std::size_t>(4, 400);
            drain(link, now, arrivals);
            link.push(now, NumberedPacket(i, size).bytes());
            std::size_t waiting = 0;
            for (const SessionTime start : starts) waiting += start > now;
            if (waiting >= limit) continue;
            const SessionTime start = std::max(now, free_at);
            starts.push_back(start);
            free_at = start + Duration{static_cast<std::int64_t>(size) * 5000};
            expected.push_back({i, free_at + milliseconds{5}});
        }
        drain(link, kNever - Duration{1}, arrivals);
        RC_ASSERT(arrivals == expected);
    }));
}

}  // namespace
}  // namespace thimble::test
