// Settings that change on the way: by a timeline, by command.
#include <gtest/gtest.h>

#include "netem/delivery_trace.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

LinkSettings delayed(Duration delay) { return {.delay = delay}; }

const Timeline kSteps{{milliseconds{10}, delayed(milliseconds{50})},
                      {milliseconds{20}, delayed(milliseconds{1})}};

TEST(LinkChange, FollowsItsTimelineFromTheStart) {
    LinkModel link(delayed(milliseconds{5}), kKey, 0, kSteps);
    for (const Duration start : {Duration{0}, Duration{seconds{9}}}) {
        link.restart(kKey, at(start));
        for (std::uint32_t i = 0; i < 30; ++i) {
            link.push(at(start + i * kMillisecond), NumberedPacket(i).bytes());
        }
        const std::vector<Arrival> arrivals = drained(link);
        ASSERT_EQ(arrivals.size(), 30U);
        // In order: what came after 20 ms waits for those before, which keep their fate.
        for (const auto& [packet, due_ms] : {std::pair{9U, 14}, {10U, 60}, {20U, 69}, {29U, 69}})
            EXPECT_EQ(arrivals[packet], (Arrival{packet, at(start + milliseconds{due_ms})}));
    }
}

// As push() and pop_due() do, but for a packet that needs no block.
TEST(LinkChange, PassesAPacketOnlyWhileNothingDelaysIt) {
    LinkModel link(delayed({}), kKey, 0, kSteps);
    EXPECT_TRUE(link.passes(at(milliseconds{9})));
    EXPECT_FALSE(link.passes(at(milliseconds{10})));  // the timeline delays from now on
    link.change(at(milliseconds{11}), delayed({}));
    link.push(at(milliseconds{11}), NumberedPacket(1).bytes());
    EXPECT_FALSE(link.passes(at(milliseconds{11})));  // one is before it
    EXPECT_FALSE(link.pop_due(at(milliseconds{11})).empty());
    EXPECT_TRUE(link.passes(at(milliseconds{11})));
    EXPECT_EQ(link.counters().pushed, 3U);
    EXPECT_EQ(link.counters().delivered, 3U);
    EXPECT_EQ(link.delays().count, 3U);
    EXPECT_EQ(link.delays().max, Duration{});
}

TEST(LinkChange, MayChangeTheOrder) {
    LinkSettings free = delayed(milliseconds{1});
    free.in_order = false;
    LinkModel link(delayed(milliseconds{20}), kKey, 0);
    link.push(at({}), NumberedPacket(0).bytes());
    link.change(at(milliseconds{1}), free);
    link.push(at(milliseconds{1}), NumberedPacket(1).bytes());
    link.change(at(milliseconds{2}), delayed(milliseconds{3}));
    link.push(at(milliseconds{2}), NumberedPacket(2).bytes());
    EXPECT_EQ(drained(link),
              (std::vector<Arrival>{
                  {1, at(milliseconds{2})}, {0, at(milliseconds{20})}, {2, at(milliseconds{20})}}));
}

TEST(LinkChange, DoesNotShiftTheFatesOfLaterPackets) {
    LinkSettings lossy = delayed(milliseconds{20});
    lossy.loss = LossSettings::independent(0.3);
    lossy.jitter = {JitterShape::kUniform, milliseconds{5}};
    lossy.in_order = false;
    LinkModel always(lossy, kKey, 0);
    LinkModel later(delayed(milliseconds{20}), kKey, 0);
    std::vector<Arrival> a = transmit(always, 500);
    for (std::uint32_t i = 0; i < 200; ++i) later.push(at(i * kMillisecond), NumberedPacket(i).bytes());
    later.change(at(milliseconds{199}), lossy);
    std::vector<Arrival> b;
    for (std::uint32_t i = 200; i < 500; ++i) {
        drain(later, at(i * kMillisecond), b);
        later.push(at(i * kMillisecond), NumberedPacket(i).bytes());
    }
    drain(later, at(seconds{9}), b);
    std::erase_if(a, [](const Arrival& x) { return x.packet < 200; });
    std::erase_if(b, [](const Arrival& x) { return x.packet < 200; });
    EXPECT_EQ(a, b);
}

LinkSettings limited(double bits_per_s) {
    LinkSettings settings;
    settings.rate.bits_per_s = bits_per_s;
    return settings;
}

// 200 bytes: 1 ms at 1.6 Mb/s. The third is on its way when the rate changes; those behind it go at the new one. Nothing but
// next_due() asks the link after a command.
TEST(LinkChange, WhatWaitsGoesAtTheNewRate) {
    const SessionTime start = at(seconds{7});
    const Duration change = milliseconds{2} + Duration{500'000};
    for (const bool by_command : {true, false}) {
        for (const double after : {16e6, 1.6e5, 0.0}) {
            LinkModel link(limited(1.6e6), kKey, 0,
                           by_command ? Timeline{} : Timeline{{change, limited(after)}}, start);
            for (std::uint32_t i = 0; i < 5; ++i) link.push(start, NumberedPacket(i).bytes());
            if (by_command) link.change(start + change, limited(after));
            EXPECT_EQ(link.next_due(), start + milliseconds{1});  // sent before, and not yet fetched
            const Duration each = after > 0 ? from_seconds(1600 / after) : Duration::zero();
            EXPECT_EQ(drained(link), (std::vector<Arrival>{{0, start + milliseconds{1}},
                                                           {1, start + milliseconds{2}},
                                                           {2, start + milliseconds{3}},
                                                           {3, start + milliseconds{3} + each},
                                                           {4, start + milliseconds{3} + 2 * each}}));
        }
    }
}

// A packet that waits for a removed slot or opportunity leaves at once, but not before the command.
TEST(LinkChange, WhatWaitsForASlotGoesWhenSlotsEnd) {
    LinkSettings slots{.delay = milliseconds{1}};
    slots.slot = {.least = milliseconds{10}, .most = milliseconds{10}};
    LinkModel link(slots, kKey, 0);
    link.push(at(milliseconds{1}), NumberedPacket(0).bytes());
    link.push(at(milliseconds{2}), NumberedPacket(1).bytes());
    EXPECT_EQ(link.next_due(), at(milliseconds{11}));
    link.change(at(milliseconds{4}), delayed(milliseconds{1}));
    EXPECT_EQ(link.next_due(), at(milliseconds{5}));
    EXPECT_EQ(drained(link), (std::vector<Arrival>{{0, at(milliseconds{5})}, {1, at(milliseconds{5})}}));
}

// A link whose last waiting packet has just gone is a link without a transmitter.
TEST(LinkChange, NoPacketIsStuckWhereARateWasRemoved) {
    for (const bool by_command : {true, false}) {
        const SessionTime change = at(Duration{500'000});
        LinkModel link(limited(1.6e6), kKey, 0,
                       by_command ? Timeline{} : Timeline{{Duration{500'000}, delayed(milliseconds{5})}});
        link.push(at({}), NumberedPacket(0).bytes());
        if (by_command) link.change(change, delayed(milliseconds{5}));
        std::vector<Arrival> arrivals;
        link.push(at(milliseconds{2}), NumberedPacket(1).bytes());
        link.push(at(milliseconds{3}), NumberedPacket(2).bytes());
        drain(link, at(seconds{1}), arrivals);
        EXPECT_EQ(link.in_flight(), 0U);
        EXPECT_EQ(arrivals,
                  (std::vector<Arrival>{
                      {0, at(milliseconds{1})}, {1, at(milliseconds{7})}, {2, at(milliseconds{8})}}));
    }
}

// A packet that overflows drops no waiting packet, and no packet leaves early.
TEST(LinkChange, ASmallerCapacityLetsNobodyLeaveEarly) {
    LinkSettings settings{.delay = milliseconds{20}, .in_order = false};
    settings.slot = {.least = milliseconds{10}, .most = milliseconds{10}};
    settings.rate.queue_packets = 1;
    settings.rate.drop = Drop::kHead;
    LinkModel link(settings, kKey, 0);
    link.push(at({}), NumberedPacket(0).bytes());               // with the slot at 0
    link.push(at(milliseconds{1}), NumberedPacket(1).bytes());  // waits for the next
    settings.capacity = 1;
    link.change(at(milliseconds{2}), settings);
    link.push(at(milliseconds{3}), NumberedPacket(2).bytes());
    EXPECT_EQ(link.counters().overflowed, 1U);
    EXPECT_EQ(link.counters().queue_full, 0U);
    EXPECT_EQ(drained(link), (std::vector<Arrival>{{0, at(milliseconds{20})}, {1, at(milliseconds{30})}}));
}

std::vector<SessionTime> due_times(LinkModel& link) {
    std::vector<SessionTime> due;
    while (link.next_due() != kNever) {
        if (const Departure out = link.pop_departure(link.next_due()); !out.bytes.empty())
            due.push_back(out.due);
    }
    return due;
}

// 200 bytes take 10 ms. Opportunities that pass while a packet is still being sent are lost.
TEST(LinkChange, DeliveriesBeginWhenTheTransmitterIsFree) {
    LinkSettings recorded = delayed(milliseconds{1});
    recorded.deliveries =
        std::make_shared<DeliveryTrace>(std::vector<std::uint32_t>{2, 4, 6, 8, 10, 12, 14, 16});
    recorded.rate.overhead_bytes = 1300;
    LinkModel link(limited(1.6e5), kKey, 0);
    for (std::uint32_t i = 0; i < 4; ++i) link.push(at({}), NumberedPacket(i).bytes());
    link.change(at(milliseconds{1}), recorded);
    EXPECT_EQ(due_times(link), (std::vector<SessionTime>{at(milliseconds{10}), at(milliseconds{12}),
                                                         at(milliseconds{14}), at(milliseconds{16})}));
}

// Another trace, while a large packet still takes its opportunities of the first.
TEST(LinkChange, AnotherTraceOfDeliveriesBeginsWhenTheFirstIsDone) {
    LinkSettings slow = delayed({}), quick = delayed({});
    slow.deliveries = std::make_shared<DeliveryTrace>(std::vector<std::uint32_t>{10});
    quick.deliveries = std::make_shared<DeliveryTrace>(std::vector<std::uint32_t>{1});
    LinkModel link(slow, kKey, 0);
    link.push(at({}), std::vector<std::uint8_t>(3000));
    link.push(at({}), NumberedPacket(1).bytes());
    link.change(at(milliseconds{12}), quick);
    EXPECT_EQ(due_times(link), (std::vector<SessionTime>{at(milliseconds{20}), at(milliseconds{21})}));
}

TEST(LinkChange, CommandOutlivesARestartAndTheTimelineComesAgain) {
    LinkModel link(delayed(milliseconds{5}), kKey, 0, kSteps);
    link.change(at(milliseconds{1}), delayed(milliseconds{7}));
    EXPECT_EQ(link.settings().delay, milliseconds{7});
    link.push(at(milliseconds{11}), NumberedPacket(0).bytes());
    EXPECT_EQ(link.settings().delay, milliseconds{50});
    link.restart(kKey);
    EXPECT_EQ(link.settings().delay, milliseconds{7});
}

}  // namespace
}  // namespace thimble::test
