// The link as a queue: when packets come out, in which order, whole, how many fit, and in how much memory.
#include <cstring>
#include <deque>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "netem/packet_store.hpp"
#include "netem/packet_trace.hpp"
#include "tests/allocation_count.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

TEST(LinkQueue, KeepsEveryByte) {
    EXPECT_TRUE(rc::check("what goes in comes out", [] {
        const bool in_order = *rc::gen::arbitrary<bool>();
        LinkModel link({.delay = milliseconds{1}, .in_order = in_order}, kKey, 0);
        std::vector<std::vector<std::uint8_t>> sent;
        for (int i = 0; i < 5; ++i) {
            const auto size = *rc::gen::inRange<std::size_t>(1, kMaxDatagramBytes + 1);
            sent.push_back(
                *rc::gen::container<std::vector<std::uint8_t>>(size, rc::gen::arbitrary<std::uint8_t>()));
            link.push(at(milliseconds{0}), sent.back());
        }
        for (const auto& expected : sent) {
            const Bytes out = link.pop_due(at(milliseconds{1}));
            RC_ASSERT(std::vector<std::uint8_t>(out.begin(), out.end()) == expected);
        }
        RC_ASSERT(link.next_due() == kNever);
    }));
}

TEST(LinkQueue, DatagramStaysValidUntilTheNextPush) {
    LinkModel link({}, kKey, 0);
    link.push(at({}), NumberedPacket(1).bytes());
    link.push(at({}), NumberedPacket(2).bytes());
    const Bytes first = link.pop_due(at({}));
    const Bytes second = link.pop_due(at({}));
    EXPECT_EQ(number_of(first), 1U);
    EXPECT_EQ(number_of(second), 2U);
}

TEST(LinkQueue, DropsTheNewestWhenFull) {
    for (const bool in_order : {true, false}) {
        LinkModel link({.delay = milliseconds{10}, .in_order = in_order, .capacity = 3}, kKey, 0);
        for (std::uint32_t i = 0; i < 5; ++i) link.push(at({}), NumberedPacket(i).bytes());
        EXPECT_EQ(link.in_flight(), 3U);
        auto arrivals = drained(link);
        link.push(at(milliseconds{10}), NumberedPacket(5).bytes());
        drain(link, at(milliseconds{20}), arrivals);
        EXPECT_EQ(arrivals, (std::vector<Arrival>{{0, at(milliseconds{10})},
                                                  {1, at(milliseconds{10})},
                                                  {2, at(milliseconds{10})},
                                                  {5, at(milliseconds{20})}}));
        EXPECT_EQ(link.counters().overflowed, 2U);
        EXPECT_EQ(link.counters().delivered, 4U);
    }
}

TEST(LinkQueue, RefusesWhatIsNoDatagram) {
    LinkModel link({}, kKey, 0);
    link.push(at({}), std::vector<std::uint8_t>(kLargestDatagramBytes + 1));
    link.push(at({}), Bytes{});
    EXPECT_EQ(link.next_due(), kNever);
    EXPECT_EQ(link.counters().oversized, 2U);
    EXPECT_EQ(link.counters().pushed, 2U);
}

TEST(LinkQueue, MeasuresTheDelayThatWasAchieved) {
    LinkModel link({.delay = milliseconds{5}}, kKey, 0);
    EXPECT_EQ(link.delays().count, 0U);
    link.push(at(milliseconds{0}), NumberedPacket(0).bytes());
    link.push(at(milliseconds{1}), NumberedPacket(1).bytes());
    link.pop_due(at(milliseconds{5}));
    link.pop_due(at(milliseconds{9}));  // late by three
    EXPECT_EQ(link.delays().count, 2U);
    EXPECT_EQ(link.delays().min, milliseconds{5});
    EXPECT_EQ(link.delays().max, milliseconds{8});
    EXPECT_DOUBLE_EQ(link.delays().mean_s(), 0.0065);
}

TEST(LinkQueue, ARestartForgetsWhichPacketWasTheLatest) {
    LinkModel link({.delay = milliseconds{1}}, kKey, 0);
    EXPECT_EQ(transmit(link, 5).size(), 5U);
    link.restart(kKey);
    EXPECT_EQ(transmit(link, 5).size(), 5U);
    EXPECT_EQ(link.counters().reordered, 0U);
}

TEST(LinkQueue, ACopyThatComesLateIsNotReordered) {
    LinkSettings settings{.delay = milliseconds{10}, .in_order = false};
    settings.jitter = {JitterShape::kUniform, milliseconds{9}};
    settings.duplicate = 1;
    LinkModel link(settings, kKey, 0);
    std::uint64_t late = 0, latest = 0;
    for (std::uint32_t i = 0; i < 200; ++i) link.push(at(i * kMillisecond), NumberedPacket(i).bytes());
    while (link.next_due() != kNever) {
        const Departure one = link.pop_departure(link.next_due());
        late += one.packet < latest && !one.copy ? 1 : 0;
        latest = std::max(latest, one.packet);
    }
    EXPECT_GT(late, 10U);
    EXPECT_EQ(link.counters().reordered, late);
}

TEST(LinkQueue, ACopyFollowsItsPacket) {
    LinkModel link({.delay = milliseconds{10}, .duplicate = 1, .in_order = false}, kKey, 0);
    link.push(at({}), NumberedPacket(0).bytes());
    link.push(at({}), NumberedPacket(1).bytes());
    for (const bool copy : {false, true, false, true}) {
        EXPECT_EQ(link.pop_departure(at(milliseconds{10})).copy, copy);
    }
}

// The queue against the plainest model of itself: a list, searched from the front.
TEST(LinkQueue, AgreesWithAList) {
    struct Entry {
        SessionTime due;
        std::uint32_t packet;
    };
    EXPECT_TRUE(rc::check("same packets at the same times", [] {
        LinkSettings settings;
        settings.delay = Duration{*rc::gen::inRange(0, 50)};
        settings.in_order = *rc::gen::arbitrary<bool>();
        settings.capacity = *rc::gen::inRange<std::size_t>(1, 20);
        LinkModel link(settings, kKey, 0);
        std::vector<Entry> list;
        std::uint64_t overflowed = 0;
        SessionTime now{};
        for (std::uint32_t i = 0; i < 200; ++i) {
            now += Duration{*rc::gen::inRange(0, 8)};
            if (*rc::gen::arbitrary<bool>()) {
                link.push(now, NumberedPacket(i).bytes());
                if (list.size() == settings.capacity) ++overflowed;
                if (list.size() < settings.capacity) list.push_back({now + settings.delay, i});
            } else {
                const Bytes out = link.pop_due(now);
                const bool due = !list.empty() && list.front().due <= now;
                RC_ASSERT(out.empty() == !due);
                if (due) {
                    RC_ASSERT(number_of(out) == list.front().packet);
                    list.erase(list.begin());
                }
            }
            RC_ASSERT(link.next_due() == (list.empty() ? kNever : list.front().due));
            RC_ASSERT(link.in_flight() == list.size());
            RC_ASSERT(link.counters().overflowed == overflowed);
        }
    }));
}

// The same with delays that differ, so that packets overtake; of those due together the first goes first.
TEST(LinkQueue, AgreesWithASortedListWhenPacketsOvertake) {
    EXPECT_TRUE(rc::check("same packets in the same order", [] {
        std::vector<TraceRow> rows;
        for (int i = 0; i < 200; ++i) rows.push_back({.at = i, .delay = Duration{*rc::gen::inRange(0, 12)}});
        LinkSettings settings;
        settings.in_order = false;
        settings.trace = std::make_shared<PacketTrace>(rows, TraceLayout{.by = TraceBy::kPacket});
        LinkModel link(settings, kKey, 0);
        std::multimap<SessionTime, std::uint32_t> list;  // equal keys stay in the order of insertion
        SessionTime now{};
        for (std::uint32_t i = 0; i < 200; ++i) {
            now += Duration{*rc::gen::inRange(0, 3)};
            link.push(now, NumberedPacket(i).bytes());
            list.emplace(now + rows[i].delay, i);
            RC_ASSERT(link.next_due() == list.begin()->first);
            while (!list.empty() && list.begin()->first <= now) {
                RC_ASSERT(number_of(link.pop_due(now)) == list.begin()->second);
                list.erase(list.begin());
            }
            RC_ASSERT(link.pop_due(now).empty());
        }
    }));
}

TEST(LinkQueue, DoesNotAllocateOnceItHasGrown) {
    for (const bool in_order : {true, false}) {
        LinkModel link({.delay = milliseconds{20},
                        .jitter = {JitterShape::kNormal, milliseconds{5}},
                        .loss = LossSettings::independent(0.1),
                        .in_order = in_order,
                        .capacity = 16},
                       kKey, 0);
        std::uint64_t bytes = 0;
        std::uint64_t before = allocation_count();
        for (std::uint32_t i = 0; i < 2000; ++i) {
            if (i == 100) before = allocation_count();
            link.push(at(i * kMillisecond), NumberedPacket(i).bytes());
            bytes += link.pop_due(at(i * kMillisecond)).size();
            if (i == 1000) link.restart(kKey);
        }
        EXPECT_EQ(allocation_count(), before);
        EXPECT_GT(bytes, 0U);
    }
}

TEST(PacketStore, SizeClassesGrowByAtMostAHalf) {
    std::size_t last = 0;
    for (std::size_t lines = 1; lines <= 1100; ++lines) {
        const std::size_t size_class = size_class_of(lines);
        ASSERT_GE(size_class, last);
        ASSERT_LE(size_class, last + 1);
        last = size_class;
    }
    EXPECT_EQ(last, 20U);
}

TEST(PacketStore, KeepsWhatItHolds) {
    EXPECT_TRUE(rc::check("no packet touches another", [] {
        PacketStore store;
        std::deque<std::pair<Packet*, std::vector<std::uint8_t>>> held;
        for (int i = 0; i < 200; ++i) {
            const bool small = *rc::gen::weightedElement<bool>({{9, true}, {1, false}});
            const auto size = *rc::gen::inRange<std::size_t>(1, small ? 600 : kLargestDatagramBytes + 1);
            const std::vector<std::uint8_t> bytes(size, static_cast<std::uint8_t>(i));
            held.emplace_back(store.take(bytes), bytes);
            if (held.size() > 20) {
                RC_ASSERT(std::memcmp(held.front().first->data(), held.front().second.data(),
                                      held.front().second.size()) == 0);
                store.give_back(held.front().first);
                held.pop_front();
            }
        }
        for (const auto& [packet, bytes] : held) {
            RC_ASSERT(packet->size == bytes.size());
            RC_ASSERT(std::memcmp(packet->data(), bytes.data(), bytes.size()) == 0);
        }
    }));
}

TEST(PacketStore, MemoryIsProportionalToWhatIsInFlight) {
    EXPECT_EQ(PacketStore().reserved_bytes(), 0U);
    for (const std::size_t size : {64U, 200U, 1400U, 60'000U}) {
        LinkModel link({.delay = std::chrono::seconds{1}, .capacity = 100'000}, kKey, 0);
        const std::vector<std::uint8_t> bytes(size);
        constexpr std::size_t kPackets = 1000;
        for (std::size_t i = 0; i < kPackets; ++i) link.push(at({}), bytes);
        // A third of a block and half of a slab may be unused, and 40 bytes are the packet's own.
        EXPECT_LE(link.memory_bytes(), 2 * kPackets * (size + 40 + 64) * 3 / 2) << size;
        EXPECT_GE(link.memory_bytes(), kPackets * size);
        const std::size_t grown = link.memory_bytes();
        for (int lap = 1; lap < 5; ++lap) {
            while (!link.pop_due(at(std::chrono::seconds{lap})).empty()) {
            }
            for (std::size_t i = 0; i < kPackets; ++i) link.push(at(std::chrono::seconds{lap}), bytes);
        }
        EXPECT_EQ(link.memory_bytes(), grown);
    }
}

}  // namespace
}  // namespace thimble::test
