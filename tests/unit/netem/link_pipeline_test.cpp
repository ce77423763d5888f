// All stages together: every packet is accounted for, and what chance does to it depends on its number only.
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "netem/delivery_trace.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

double chance() { return *rc::gen::inRange(0, 4) * 0.1; }

JitterSettings random_jitter() {
    return {.shape = *rc::gen::element(JitterShape::kNone, JitterShape::kUniform, JitterShape::kNormal,
                                       JitterShape::kPareto, JitterShape::kParetoNormal),
            .spread = milliseconds{*rc::gen::inRange(1, 10)},
            .correlation = *rc::gen::element(0.0, 0.5)};
}

LossSettings random_loss() {
    return *rc::gen::element(LossSettings{}, LossSettings::independent(0.2), LossSettings::gilbert(0.2, 3));
}

LinkSettings random_link() {
    LinkSettings link;
    link.delay = milliseconds{*rc::gen::inRange(0, 20)};
    link.jitter = random_jitter();
    link.loss = random_loss();
    link.duplicate = chance();
    link.corrupt = chance();
    link.corrupt_bits = *rc::gen::inRange(1U, 20U);
    link.reorder = chance();
    link.reorder_gap = *rc::gen::inRange(1U, 4U);
    link.in_order = *rc::gen::arbitrary<bool>();
    const int sender = *rc::gen::inRange(0, 4);
    if (sender % 2 == 1) link.rate.bits_per_s = 1e6;
    if (sender >= 2) link.slot = {.least = milliseconds{1}, .most = milliseconds{4}, .packets = 3};
    if (*rc::gen::inRange(0, 5) == 0) {
        link.deliveries = std::make_shared<DeliveryTrace>(std::vector<std::uint32_t>{1, 1, 7, 20});
    }
    link.rate.queue_packets = *rc::gen::inRange<std::size_t>(0, 5);
    link.rate.queue_bytes = *rc::gen::element<std::size_t>(0, 1000);
    link.rate.drop = *rc::gen::element(Drop::kTail, Drop::kHead);
    if (*rc::gen::arbitrary<bool>()) {
        link.outages = {{.start = milliseconds{10}, .length = milliseconds{5}, .every = milliseconds{40}}};
    }
    link.capacity = *rc::gen::element<std::size_t>(3, 1000);
    return link;
}

struct DropTally final : LinkObserver {
    std::map<DropReason, std::uint64_t> counts;
    void on_drop(std::uint64_t /*packet*/, SessionTime /*now*/, std::size_t /*bytes*/,
                 DropReason reason) override {
        ++counts[reason];
    }
};

void expect_balance(const LinkModel& link, DropTally& drops) {
    const LinkCounters& c = link.counters();
    RC_ASSERT(c.pushed + c.duplicated ==
              c.lost + c.outage + c.oversized + c.queue_full + c.overflowed + c.delivered + link.in_flight());
    RC_ASSERT(drops.counts[DropReason::kLost] == c.lost);
    RC_ASSERT(drops.counts[DropReason::kOutage] == c.outage);
    RC_ASSERT(drops.counts[DropReason::kOversized] == c.oversized);
    RC_ASSERT(drops.counts[DropReason::kQueueFull] == c.queue_full);
    RC_ASSERT(drops.counts[DropReason::kOverflowed] == c.overflowed);
    RC_ASSERT(link.delays().count == c.delivered);
}

TEST(LinkPipeline, EveryPacketIsAccountedFor) {
    EXPECT_TRUE(rc::check("what goes in comes out or is counted", [] {
        LinkModel link(random_link(), kKey, 0, {{milliseconds{30}, random_link()}});
        DropTally drops;
        link.observe(&drops);
        SessionTime now{};
        std::uint64_t delivered = 0;
        SessionTime last_due{};
        const auto pop = [&](SessionTime time) {
            const Departure out = link.pop_departure(time);
            if (out.bytes.empty()) return;
            ++delivered;
            RC_ASSERT(out.due <= time);
            RC_ASSERT(out.received <= out.due);
            RC_ASSERT(out.due >= last_due);
            last_due = out.due;
            if (!out.corrupted) {
                RC_ASSERT(number_of(out.bytes) == out.packet);
            }
        };
        for (std::uint32_t i = 0; i < 150; ++i) {
            now += microseconds{*rc::gen::inRange(0, 800)};
            while (link.next_due() <= now) pop(link.next_due());
            link.push(now, i % 50 == 49 ? Bytes{} : NumberedPacket(i, 4 + i).bytes());
            if (i == 100) link.change(now, random_link());
            expect_balance(link, drops);
        }
        while (link.next_due() != kNever) pop(link.next_due());
        expect_balance(link, drops);
        RC_ASSERT(link.in_flight() == 0U);
        RC_ASSERT(link.counters().delivered == delivered);
    }));
}

TEST(LinkPipeline, InOrderMeansInOrder) {
    EXPECT_TRUE(rc::check("no packet before an earlier one", [] {
        LinkSettings settings = random_link();
        settings.in_order = true;
        LinkModel link(settings, kKey, 0);
        std::uint32_t last = 0;
        for (std::uint32_t i = 0; i < 100; ++i)
            link.push(at(i * microseconds{100}), NumberedPacket(i).bytes());
        while (link.next_due() != kNever) {
            const Departure out = link.pop_departure(link.next_due());
            if (out.bytes.empty()) continue;
            RC_ASSERT(out.packet >= last);
            last = static_cast<std::uint32_t>(out.packet);
        }
        RC_ASSERT(link.counters().reordered == 0U);
    }));
}

LinkSettings eventful() {
    LinkSettings settings{
        .delay = milliseconds{40},
        .jitter = {.shape = JitterShape::kGamma, .spread = milliseconds{10}, .correlation = 0.5},
        .loss = LossSettings::gilbert(0.1, 4)};
    settings.duplicate = 0.05;
    settings.corrupt = 0.05;
    settings.corrupt_bits = 3;
    settings.reorder = 0.1;
    settings.reorder_gap = 3;
    settings.in_order = false;
    return settings;
}

// All that chance decides about one packet, and the flipped bits as a checksum.
struct Fate {
    PacketFate fate;
    std::uint32_t sum = 0;
    bool operator==(const Fate&) const = default;
};

Fate fate_of(LinkFates& fates, std::uint64_t packet, Duration time) {
    Fate result{fates.decide(packet, time), 0};
    if (!result.fate.corrupted) return result;
    std::array<std::uint8_t, 4> bytes{};
    fates.flip_bits(packet, bytes);
    std::memcpy(&result.sum, bytes.data(), 4);
    return result;
}

// FNV-1a over the fates of a million packets: the same number from every compiler and build type.
TEST(LinkPipeline, MillionFatesAreTheSameForTheSameSeedWhateverTheTiming) {
    const LinkSettings settings = eventful();
    const auto shape = std::make_shared<const DelayShape>(settings.jitter, settings.delay);
    LinkFates one(kKey, 1);
    LinkFates two(kKey, 1);
    for (LinkFates* fates : {&one, &two}) fates->configure(settings, shape);
    std::uint64_t hash = 0xCBF29CE484222325U;
    const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 0x100000001B3U; };
    for (std::uint64_t packet = 0; packet < 1'000'000; ++packet) {
        const Fate fate = fate_of(one, packet, packet * kMillisecond);
        ASSERT_EQ(fate, fate_of(two, packet, packet * packet * Duration{7})) << packet;
        mix(static_cast<std::uint64_t>(fate.fate.delay.count()));
        mix(static_cast<std::uint64_t>(fate.fate.copy_delay.count()));
        mix(fate.sum + (fate.fate.lost ? 1 : 0) + (fate.fate.duplicated ? 2 : 0) +
            (fate.fate.skipped ? 4 : 0));
    }
    EXPECT_EQ(hash, 15637353813777741995U);
}

}  // namespace
}  // namespace thimble::test
