#include "netem/stages/slots.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

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

// The grid is the same whoever asks for it and when.
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

TEST(Slots, SwitchedOnLaterBeginThen) {
    Slots slots(kKey, 0);
    EXPECT_FALSE(slots.active());
    slots.configure({.least = milliseconds{10}, .most = milliseconds{10}}, milliseconds{3});
    EXPECT_TRUE(slots.active());
    EXPECT_EQ(slots.opening(milliseconds{4}, {}, 1), milliseconds{13});
}

}  // namespace
}  // namespace thimble::test
