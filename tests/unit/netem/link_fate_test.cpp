// The fate of each packet: lost or not, how long it waits; statistics, order, and what it may depend on.
#include <algorithm>
#include <array>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

LinkSettings jittery(JitterShape jitter, bool in_order) {
    return {.delay = milliseconds{20}, .jitter = {jitter, milliseconds{5}}, .in_order = in_order};
}

TEST(LinkFate, DelayIsNeverNegative) {
    for (const JitterShape jitter : {JitterShape::kUniform, JitterShape::kNormal}) {
        LinkSettings settings = jittery(jitter, false);
        settings.delay = milliseconds{2};
        LinkModel link(settings, kKey, 0);
        Duration least = Duration::max();
        for (const Arrival& arrival : transmit(link, 5000)) {
            least = std::min(least, arrival.time - at(arrival.packet * kMillisecond));
        }
        EXPECT_EQ(least, Duration::zero());
        EXPECT_EQ(link.counters().delivered, 5000U);
    }
}

// In order, a packet leaves when it and all before it would have left on their own.
TEST(LinkFate, OrderOnlyRaisesDueTimes) {
    LinkModel free(jittery(JitterShape::kNormal, false), kKey, 0);
    LinkModel ordered(jittery(JitterShape::kNormal, true), kKey, 0);
    auto expected = transmit(free, 2000);
    std::sort(expected.begin(), expected.end(),
              [](const Arrival& a, const Arrival& b) { return a.packet < b.packet; });
    for (std::size_t i = 1; i < expected.size(); ++i) {
        expected[i].time = std::max(expected[i].time, expected[i - 1].time);
    }
    EXPECT_EQ(transmit(ordered, 2000), expected);
}

// RFC 3168: the last two bits of the traffic class. The same packets are marked that are lost without ECN.
TEST(LinkFate, MarksInsteadOfLosingWhoUnderstandsEcn) {
    LinkSettings settings{};
    settings.loss = LossSettings::independent(0.3);
    settings.duplicate = 0.1;
    settings.in_order = true;
    settings.ecn = true;
    for (const auto traffic_class : std::array<std::uint8_t, 3>{0xb8, 0xb9, 0xba}) {
        LinkModel link(settings, kKey, 0);
        for (std::uint32_t i = 0; i < 1000; ++i)
            link.push(SessionTime{}, NumberedPacket(i).bytes(), traffic_class);
        std::uint64_t marked = 0, others = 0;
        for (Departure out = link.pop_departure(SessionTime{}); !out.bytes.empty();
             out = link.pop_departure(SessionTime{})) {
            marked += !out.copy && out.traffic_class == 0xbb ? 1 : 0;
            others += out.traffic_class == traffic_class ? 1 : 0;
        }
        const bool understands = traffic_class != 0xb8;
        EXPECT_EQ(marked, link.counters().marked);
        EXPECT_GT(others, 0U);
        EXPECT_EQ(link.counters().lost > 0, !understands);
        EXPECT_EQ(link.counters().marked > 0, understands);
    }
}

TEST(LinkFate, LosesNothingOrEverything) {
    LinkModel none({.loss = LossSettings::independent(0)}, kKey, 0);
    LinkModel all({.loss = LossSettings::independent(1)}, kKey, 0);
    EXPECT_EQ(transmit(none, 1000).size(), 1000U);
    EXPECT_TRUE(transmit(all, 1000).empty());
}

std::set<std::uint32_t> survivors(LinkModel& link, std::uint32_t count, Duration period) {
    std::set<std::uint32_t> numbers;
    for (const Arrival& arrival : transmit(link, count, period)) numbers.insert(arrival.packet);
    return numbers;
}

TEST(LinkFate, DoesNotDependOnTimingSizeOrOrder) {
    LinkSettings settings = jittery(JitterShape::kNormal, false);
    settings.loss = LossSettings::independent(0.2);
    LinkModel reference(settings, kKey, 1);
    auto expected = transmit(reference, 500);
    std::sort(expected.begin(), expected.end(),
              [](const Arrival& a, const Arrival& b) { return a.packet < b.packet; });
    EXPECT_TRUE(rc::check("fates depend on the packet number only", [&] {
        LinkModel link(settings, kKey, 1);
        SessionTime now{};
        for (std::uint32_t i = 0, next = 0; i < 500; ++i) {
            now += Duration{*rc::gen::inRange(0, 5'000'000)};
            const auto size = *rc::gen::inRange<std::size_t>(4, kMaxDatagramBytes + 1);
            const std::uint64_t lost_before = link.counters().lost;
            link.push(now, NumberedPacket(i, size).bytes());
            const bool lost = link.counters().lost != lost_before;
            RC_ASSERT(lost == (next >= expected.size() || expected[next].packet != i));
            if (lost) continue;
            const SessionTime due = link.next_due();
            RC_ASSERT(due - now == expected[next].time - at(i * kMillisecond));
            RC_ASSERT(number_of(link.pop_due(due)) == i);
            ++next;
        }
    }));
}

TEST(LinkFate, DiffersBetweenDirectionsTrialsAndSubjects) {
    LinkSettings settings = jittery(JitterShape::kNormal, false);
    settings.loss = LossSettings::independent(0.5);
    StreamKey other_trial = kKey, other_subject = kKey, other_study = kKey;
    ++other_trial.trial;
    ++other_subject.subject;
    ++other_study.study;
    std::set<std::set<std::uint32_t>> fates;
    std::set<std::int64_t> first_delays;
    const std::pair<StreamKey, std::uint32_t> links[]{{kKey, 0},        {kKey, 1},          {kKey, 2},
                                                      {other_trial, 0}, {other_subject, 0}, {other_study, 0}};
    for (const auto& [key, direction] : links) {
        LinkModel link(settings, key, direction);
        fates.insert(survivors(link, 200, kMillisecond));
        LinkModel lossless(jittery(JitterShape::kNormal, false), key, direction);
        lossless.push(at({}), NumberedPacket(0).bytes());
        first_delays.insert(to_nanoseconds(lossless.next_due()));
    }
    EXPECT_EQ(fates.size(), 6U);
    EXPECT_EQ(first_delays.size(), 6U);
}

TEST(LinkFate, RestartReplaysTheSameFates) {
    LinkSettings settings = jittery(JitterShape::kNormal, false);
    settings.loss = LossSettings::independent(0.2);
    LinkModel link(settings, kKey, 0);
    const auto first = transmit(link, 1000);
    link.push(at(milliseconds{1}), NumberedPacket(77).bytes());  // still in flight at the restart
    link.push(at(milliseconds{1}), NumberedPacket(78).bytes());
    StreamKey other = kKey;
    ++other.trial;
    link.restart(other);
    EXPECT_EQ(link.next_due(), kNever);
    EXPECT_EQ(link.in_flight(), 0U);
    EXPECT_EQ(link.counters().pushed, 0U);
    EXPECT_EQ(link.delays().count, 0U);
    EXPECT_NE(transmit(link, 1000), first);
    link.restart(kKey);
    EXPECT_EQ(transmit(link, 1000), first);
}

TEST(PacketNumbers, DependOnThePacketAlone) {
    PacketNumbers numbers(kKey), fresh(kKey);
    const double third = numbers.uniform(3);
    EXPECT_NE(numbers.uniform(7), third);
    EXPECT_EQ(numbers.uniform(3), third);
    EXPECT_EQ(fresh.uniform(3), third);
}

}  // namespace
}  // namespace thimble::test
