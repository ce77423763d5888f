#include "netem/stages/slots.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/unit/netem/link_test_tools.hpp"
#include "tests/unit/netem/statistics_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

Slots slots_of(const SlotSettings& settings) {
    Slots slots(kKey, 0);
    slots.configure(settings, {});
    return slots;
}

TEST(Slots, PacketsWaitForTheNextOne) {
    Slots slots = slots_of({.least = milliseconds{10}, .most = milliseconds{10}});
    EXPECT_EQ(slots.opening({}, {}, 100), milliseconds{0});
    EXPECT_EQ(slots.opening(Duration{1}, {}, 100), milliseconds{10});
    EXPECT_EQ(slots.opening(milliseconds{10}, {}, 100), milliseconds{10});  // in its very instant
    EXPECT_EQ(slots.opening(milliseconds{10} + Duration{1}, {}, 100), milliseconds{20});
    EXPECT_EQ(slots.opening(milliseconds{1'000'000'001}, {}, 100), milliseconds{1'000'000'010});
}

TEST(Slots, TakeNoMoreThanTheirLimits) {
    Slots by_packets = slots_of({.least = milliseconds{10}, .most = milliseconds{10}, .packets = 2});
    Slots by_bytes = slots_of({.least = milliseconds{10}, .most = milliseconds{10}, .bytes = 500});
    for (int i = 0; i < 6; ++i) {
        const Duration expected = i / 2 * milliseconds{10};
        EXPECT_EQ(by_packets.opening({}, {}, 200), expected);
        EXPECT_EQ(by_bytes.opening({}, {}, 200), expected);
        by_packets.take(200);
        by_bytes.take(200);
    }
    EXPECT_EQ(by_bytes.opening({}, {}, 9000), milliseconds{30});  // larger than any slot: one for itself
    by_bytes.take(9000);
    EXPECT_EQ(by_bytes.opening({}, {}, 1), milliseconds{40});
}

TEST(Slots, AreFullAtExactlyTheirBytes) {
    Slots slots = slots_of({.least = milliseconds{10}, .most = milliseconds{10}, .bytes = 500});
    const std::pair<std::size_t, int> expected[]{{250, 0},  {250, 0}, {1, 10},  {499, 10},
                                                 {500, 20}, {1, 30},  {500, 40}};
    for (const auto& [bytes, slot_ms] : expected) {
        EXPECT_EQ(slots.opening({}, {}, bytes), milliseconds{slot_ms});
        slots.take(bytes);
    }
}

// The burst of a slot goes on while the medium is busy with it, until the next slot opens.
TEST(Slots, ABurstIsSentBackToBack) {
    Slots slots = slots_of({.least = milliseconds{10}, .most = milliseconds{10}});
    EXPECT_EQ(slots.opening({}, milliseconds{4}, 1), milliseconds{4});
    EXPECT_EQ(slots.opening({}, milliseconds{9}, 1), milliseconds{9});
    EXPECT_EQ(slots.opening({}, milliseconds{13}, 1), milliseconds{13});
    EXPECT_EQ(slots.opening(milliseconds{11}, milliseconds{14}, 1), milliseconds{20});
}

TEST(Slots, GapsLieWithinTheirRangeAndVary) {
    Slots slots = slots_of({.least = microseconds{800}, .most = milliseconds{10}, .packets = 1});
    std::set<Duration> gaps;
    double sum_s = 0;
    Duration last = slots.opening({}, {}, 1);
    for (int i = 0; i < 20'000; ++i) {
        slots.take(1);
        const Duration opens = slots.opening({}, {}, 1);
        ASSERT_GE(opens - last, microseconds{800});
        ASSERT_LE(opens - last, milliseconds{10});
        gaps.insert(opens - last);
        sum_s += to_seconds(opens - last);
        last = opens;
    }
    EXPECT_GT(gaps.size(), 15'000U);
    EXPECT_NEAR(sum_s / 20'000, 0.0054, 4 * 0.0092 / std::sqrt(12 * 20'000.0));
}

TEST(Slots, HaveTheShapeThatIsAsked) {
    for (const JitterShape shape : {JitterShape::kNormal, JitterShape::kPareto}) {
        Slots slots =
            slots_of({.least = milliseconds{8}, .most = milliseconds{12}, .packets = 1, .shape = shape});
        constexpr int kSlots = 20'000;
        double squares_s2 = 0;
        Duration last = slots.opening({}, {}, 1);
        const Duration first = last;
        for (int i = 0; i < kSlots; ++i) {
            slots.take(1);
            const Duration next = slots.opening({}, {}, 1);
            const double off_s = to_seconds(next - last) - 0.010;
            squares_s2 += off_s * off_s;
            last = next;
        }
        EXPECT_NEAR(to_seconds(last - first) / kSlots, 0.010, 0.0001);
        EXPECT_NEAR(std::sqrt(squares_s2 / kSlots), 0.002, shape == JitterShape::kNormal ? 0.0001 : 0.0005);
    }
}

// Gaps that would be negative are none, also over a pause of many slots.
TEST(Slots, AShapeIsCutAtZero) {
    Slots slots =
        slots_of({.least = -milliseconds{2}, .most = milliseconds{4}, .shape = JitterShape::kNormal});
    const Duration late = slots.opening(seconds{1000}, {}, 1);
    EXPECT_GE(late, seconds{1000});
    EXPECT_LT(late, seconds{1001});
}

// The grid is the same for every caller at any time.
TEST(Slots, DoNotDependOnTheTraffic) {
    const SlotSettings settings{.least = milliseconds{1}, .most = milliseconds{9}};
    Slots busy = slots_of(settings);
    for (int i = 0; i < 5000; ++i) busy.opening(i * microseconds{700}, {}, 1);
    for (int i = 3500; i < 5000; ++i) {
        Slots fresh = slots_of(settings);
        ASSERT_EQ(busy.opening(i * milliseconds{1}, {}, 1), fresh.opening(i * milliseconds{1}, {}, 1));
        if (i % 50 != 0) i += 49;
    }
}

// A pause of a year costs a few draws, and of time, too, there is always the right slot: the next.
TEST(Slots, APauseCostsAFewSteps) {
    for (const SlotSettings& settings :
         {SlotSettings{.least = milliseconds{1}, .most = milliseconds{9}},
          SlotSettings{.least = Duration{0}, .most = microseconds{2}},
          SlotSettings{.least = milliseconds{1}, .most = milliseconds{1} + Duration{1}}}) {
        for (const bool busy : {false, true}) {  // the pause of the packets, or one while the medium is taken
            Slots slots = slots_of(settings);
            slots.take(1);
            const Duration end = std::chrono::hours{24 * 365};
            const Duration opens = busy ? slots.opening({}, end, 1) : slots.opening(end, {}, 1);
            EXPECT_GE(opens, end);
            EXPECT_LE(opens, end + settings.most);
        }
    }
}

// Waiting times after a pause against those of slots that are counted one by one: the same distribution.
TEST(Slots, APauseChangesNoDistribution) {
    for (const SlotSettings& settings : {SlotSettings{.least = milliseconds{1}, .most = milliseconds{9}},
                                         SlotSettings{.least = milliseconds{9}, .most = milliseconds{10}}}) {
        std::vector<double> jumped, counted;
        const Duration mean = (settings.least + settings.most) / 2;
        const Duration pause = 3 * Slots::kMostSteps * mean;
        for (std::uint32_t trial = 0; trial < 400; ++trial) {
            StreamKey key = kKey;
            key.trial = trial;
            Slots once(key, 0), often(key, 1);
            for (Slots* slots : {&once, &often}) slots->configure(settings, {});
            jumped.push_back(to_seconds(once.opening(pause, {}, 1) - pause));
            for (int part = 1; part < 6; ++part) often.opening(part * pause / 6, {}, 1);
            counted.push_back(to_seconds(often.opening(pause, {}, 1) - pause));
        }
        // The forward recurrence time of a renewal process: density P(gap > x) / mean.
        const double least_s = to_seconds(settings.least), most_s = to_seconds(settings.most);
        const auto below = [&](double x) {
            const double beyond = std::clamp(x, least_s, most_s) - least_s;
            return (std::min(x, least_s) + beyond - beyond * beyond / (2 * (most_s - least_s))) /
                   to_seconds(mean);
        };
        EXPECT_LT(ks_distance(jumped, below), ks_limit(400));
        EXPECT_LT(ks_distance(counted, below), ks_limit(400));
    }
}

TEST(Slots, BeginWithTheirFlow) {
    LinkSettings settings;
    settings.slot = {.least = milliseconds{10}, .most = milliseconds{10}};
    for (const Timeline& timeline : {Timeline{}, Timeline{{milliseconds{50}, settings}}}) {
        const SessionTime start = at(milliseconds{100}), opened = at(milliseconds{203});
        LinkModel link(timeline.empty() ? settings : LinkSettings{}, kKey, 0, timeline, start, opened);
        link.push(opened, NumberedPacket(0).bytes());
        link.push(opened + milliseconds{1}, NumberedPacket(1).bytes());
        EXPECT_EQ(drained(link), (std::vector<Arrival>{{0, opened}, {1, opened + milliseconds{10}}}));
    }
}

TEST(Slots, SwitchedOnLaterBeginThen) {
    Slots slots(kKey, 0);
    EXPECT_FALSE(slots.active());
    slots.configure({.least = milliseconds{10}, .most = milliseconds{10}}, milliseconds{3});
    EXPECT_TRUE(slots.active());
    EXPECT_EQ(slots.opening(milliseconds{4}, {}, 1), milliseconds{13});
}

TEST(Outage, HoldsFromItsStartUntilBeforeItsEnd) {
    const std::vector<Outage> once{{.start = seconds{1}, .length = seconds{2}}};
    EXPECT_FALSE(is_out(once, seconds{1} - Duration{1}));
    EXPECT_TRUE(is_out(once, seconds{1}));
    EXPECT_TRUE(is_out(once, seconds{3} - Duration{1}));
    EXPECT_FALSE(is_out(once, seconds{3}));
    EXPECT_FALSE(is_out({}, seconds{1}));
}

TEST(Outage, ComesAgain) {
    const std::vector<Outage> handovers{
        {.start = seconds{5}, .length = milliseconds{140}, .every = seconds{15}},
        {.start = milliseconds{14'925}, .length = milliseconds{75}}};
    for (int lap = 0; lap < 1000; ++lap) {
        const Duration start = seconds{5} + lap * seconds{15};
        ASSERT_FALSE(is_out(handovers, start - Duration{1}));
        ASSERT_TRUE(is_out(handovers, start));
        ASSERT_FALSE(is_out(handovers, start + milliseconds{140}));
    }
    EXPECT_TRUE(is_out(handovers, milliseconds{14'950}));
    EXPECT_FALSE(is_out(handovers, milliseconds{29'950}));
}

// Counted from the start of the trial; what is on its way still arrives.
TEST(Outage, DropsWhatIsPushedMeanwhile) {
    LinkSettings settings{.delay = milliseconds{10}};
    settings.outages = {{.start = milliseconds{20}, .length = milliseconds{30}}};
    LinkModel link(settings, kKey, 0);
    for (const Duration start : {Duration{seconds{0}}, Duration{seconds{100}}}) {
        link.restart(kKey, at(start));
        std::vector<Arrival> arrivals;
        for (std::uint32_t i = 0; i < 100; ++i) {
            link.push(at(start + i * kMillisecond), NumberedPacket(i).bytes());
            drain(link, at(start + i * kMillisecond), arrivals);
        }
        drain(link, at(start + seconds{1}), arrivals);
        ASSERT_EQ(arrivals.size(), 70U);
        EXPECT_EQ(arrivals[19].packet, 19U);
        EXPECT_EQ(arrivals[20].packet, 50U);
        EXPECT_EQ(link.counters().outage, 30U);
    }
}

}  // namespace
}  // namespace thimble::test
