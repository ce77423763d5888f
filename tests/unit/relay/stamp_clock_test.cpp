#include "common/runtime/stamp_clock.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

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
