// When to begin the work before a due time, how long to spin, how many datagrams to read, and when a datagram came.
#include <gtest/gtest.h>

#include "common/runtime/stamp_clock.hpp"
#include "common/runtime/wait_margin.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "netem/relay/send_lead.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

TEST(LeastLately, IsZeroUntilEnoughIsKnown) {
    LeastLately least;
    for (int i = 0; i < 63; ++i) least.add(nanoseconds{700});
    EXPECT_EQ(least.least(), Duration::zero());
    least.add(nanoseconds{900});
    EXPECT_EQ(least.least(), nanoseconds{700});
}

TEST(LeastLately, FollowsAShorterOneAtOnceAndForgetsItAfterTwoGenerations) {
    LeastLately least;
    const auto add = [&](int times, Duration took) {
        for (int i = 0; i < times; ++i) least.add(took);
    };
    add(64, nanoseconds{700});
    least.add(nanoseconds{300});
    EXPECT_EQ(least.least(), nanoseconds{300});
    add(63 + 64, nanoseconds{800});
    EXPECT_EQ(least.least(), nanoseconds{300});
    add(64, nanoseconds{800});
    EXPECT_EQ(least.least(), nanoseconds{800});
}

TEST(SendCost, IsNoMoreThanACallTakes) {
    const Duration cost = measure_send_cost();
    EXPECT_GE(cost, Duration::zero());
    EXPECT_LT(cost, microseconds{100});
}

TEST(ReceiveTurn, AsksForOneWhereOneComes) {
    ReceiveTurn turn;
    for (int i = 0; i < 100; ++i) {
        EXPECT_LE(turn.most(), 2U);
        turn.got(1);
    }
}

TEST(ReceiveTurn, AsksForAllThatFitWhereManyCome) {
    ReceiveTurn turn;
    for (int i = 0; i < 40; ++i) turn.got(turn.most());
    EXPECT_EQ(turn.most(), ReceiveBatch::kSize);
    turn.got(0);
    EXPECT_EQ(turn.most(), ReceiveBatch::kSize / 2);
    for (int i = 0; i < 10; ++i) turn.got(0);
    EXPECT_EQ(turn.most(), 1U);
}

SessionTime at_ms(std::int64_t ms) { return SessionTime{milliseconds{ms}}; }

// Of 512 latenesses, as many us late as `late_us` says of each; then the margin.
TEST(WaitMargin, CoversAllButTheTwoWorstOfTheLastThatAreNoStalls) {
    struct Case {
        const char* name;
        int (*late_us)(int i);
        int margin_us;
    };
    WaitMargin margin;
    for (const Case& c :
         {Case{"two worst", [](int i) { return i == 100 || i == 300 ? 150 : 20; }, 20},
          Case{"three worst", [](int i) { return i % 170 == 0 ? 150 : 20; }, 150},
          Case{"all late", [](int) { return 90; }, 90}, Case{"long ago", [](int) { return 7; }, 7},
          Case{"stalls", [](int i) { return i % 2 == 0 ? 9000 : 12; }, 12}}) {
        for (int i = 0; i < 512; ++i) margin.add(microseconds{c.late_us(i)});
        EXPECT_EQ(margin.margin(), microseconds{c.margin_us}) << c.name;
    }
}

TEST(WaitMargin, IsNeverNothing) {
    WaitMargin margin;
    EXPECT_GE(margin.margin(), microseconds{50}) << "before the timer is known";
    for (int i = 0; i < 512; ++i) margin.add(Duration::zero());
    EXPECT_GE(margin.margin(), microseconds{2});
}

TEST(SpinBudget, AllowsFourFifthsOfATenthOfASecond) {
    SpinBudget budget;
    EXPECT_EQ(budget.left(at_ms(1000)), milliseconds{80});
    budget.spent(at_ms(1030), milliseconds{30});
    budget.spent(at_ms(1080), milliseconds{50});
    EXPECT_LE(budget.left(at_ms(1080)), Duration::zero());
}

TEST(SpinBudget, ComesBackAsTimePasses) {
    SpinBudget budget;
    budget.spent(at_ms(1010), milliseconds{10});
    budget.spent(at_ms(1090), milliseconds{70});
    EXPECT_EQ(budget.left(at_ms(1100)), Duration::zero());
    EXPECT_EQ(budget.left(at_ms(1125)), milliseconds{10}) << "the first spell is more than 100 ms ago";
    EXPECT_EQ(budget.left(at_ms(1210)), milliseconds{80});
    EXPECT_EQ(budget.left(at_ms(100000)), milliseconds{80});
}

// A thread that spins whenever it may never exceeds the share in any window.
TEST(SpinBudget, HoldsInEveryWindow) {
    SpinBudget budget;
    std::vector<int> spun(2000, 0);
    for (int ms = 0; ms < 2000; ++ms) {
        if (budget.left(at_ms(1000 + ms)) < milliseconds{1}) continue;
        spun[static_cast<std::size_t>(ms)] = 1;
        budget.spent(at_ms(1000 + ms + 1), milliseconds{1});
    }
    int total = 0;
    for (std::size_t start = 0; start + 100 <= spun.size(); ++start) {
        int sum = 0;
        for (std::size_t i = start; i < start + 100; ++i) sum += spun[i];
        EXPECT_LE(sum, 80) << "from " << start;
        total = std::max(total, sum);
    }
    EXPECT_GE(total, 70) << "and it may spin most of the time";
}

constexpr std::int64_t kEpoch_ns = 1'700'000'000'000'000'000;

// Readings at `monotonic` while the realtime clock is `shift` ahead of where it was.
ClockPair pair(Duration monotonic, Duration shift = {}) {
    return {SessionTime{monotonic}, SessionTime{monotonic + Duration{100}},
            kEpoch_ns + (monotonic + shift).count() + 50};
}
std::int64_t stamp(Duration monotonic, Duration shift = {}) {
    return kEpoch_ns + (monotonic + shift).count();
}

TEST(StampClock, BecomesSessionTime) {
    StampClock clock;
    clock.update(pair(seconds{5}));
    EXPECT_EQ(clock.to_session(stamp(seconds{5} - microseconds{30}), SessionTime{seconds{5}}),
              SessionTime{seconds{5} - microseconds{30}});
    EXPECT_EQ(clock.untrusted(), 0U);
}

TEST(StampClock, BelievesNothingBeforeItsFirstReading) {
    StampClock clock;
    EXPECT_EQ(clock.to_session(stamp(seconds{4}), SessionTime{seconds{5}}), SessionTime{seconds{5}});
    EXPECT_EQ(clock.untrusted(), 1U);
}

TEST(StampClock, FollowsASlew) {
    StampClock clock;
    Duration shift{};
    for (int i = 1; i <= 1000; ++i) {
        shift += microseconds{4};  // 400 ppm of 10 ms
        clock.update(pair(i * milliseconds{10}, shift));
    }
    EXPECT_EQ(clock.steps(), 0U);
    EXPECT_EQ(clock.to_session(stamp(seconds{10} - microseconds{7}, shift), SessionTime{seconds{10}}),
              SessionTime{seconds{10} - microseconds{7}});
}

TEST(StampClock, AStepNeverReachesTheDueTimes) {
    for (const Duration step :
         {Duration{seconds{3600}}, Duration{-seconds{3600}}, Duration{milliseconds{2}}}) {
        StampClock clock;
        clock.update(pair(seconds{1}));
        clock.update(pair(seconds{1} + milliseconds{1}, step));
        EXPECT_EQ(clock.steps(), 1U);
        const SessionTime now{seconds{1} + milliseconds{1}};
        EXPECT_EQ(clock.to_session(stamp(seconds{1}), now), now) << "stamped before the step, read after it";
        EXPECT_EQ(clock.to_session(stamp(seconds{1}, step), now), now)
            << "which of the two it was cannot be known";
        clock.update(pair(seconds{2}, step));
        EXPECT_EQ(clock.to_session(stamp(seconds{2} - microseconds{9}, step), SessionTime{seconds{2}}),
                  SessionTime{seconds{2} - microseconds{9}})
            << "later ones are good again";
    }
}

TEST(StampClock, TakesNoStampFromTheFuture) {
    StampClock clock;
    clock.update(pair(seconds{5}));
    EXPECT_EQ(clock.to_session(stamp(seconds{6}), SessionTime{seconds{5}}), SessionTime{seconds{5}});
    EXPECT_EQ(clock.to_session(0, SessionTime{seconds{5}}), SessionTime{seconds{5}}) << "no stamp at all";
    EXPECT_EQ(clock.untrusted(), 2U);
}

TEST(StampClock, LeavesOutATornReading) {
    StampClock clock;
    clock.update(pair(seconds{1}));
    clock.update(
        {SessionTime{seconds{2}}, SessionTime{seconds{2} + milliseconds{8}}, kEpoch_ns + 2'000'000'000});
    EXPECT_EQ(clock.steps(), 0U);
}

}  // namespace
}  // namespace thimble
