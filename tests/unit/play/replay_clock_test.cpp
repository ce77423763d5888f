#include "session/play/replay_clock.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr SessionTime kBegin = at(seconds{100});

TEST(ReplayClock, StandsUntilItIsLetRun) {
    ReplayClock clock(10);
    EXPECT_EQ(clock.time_s(kBegin), 0);
    EXPECT_EQ(clock.time_s(kBegin + seconds{5}), 0);
    clock.resume(kBegin + seconds{5});
    EXPECT_EQ(clock.time_s(kBegin + seconds{7}), 2);
    clock.resume(kBegin + seconds{7});  // said again
    EXPECT_EQ(clock.time_s(kBegin + seconds{8}), 3);
}

TEST(ReplayClock, RunsAtItsSpeedWithoutAJumpWhenThatChanges) {
    ReplayClock clock(10, 0.5);
    clock.resume(kBegin);
    EXPECT_EQ(clock.time_s(kBegin + seconds{4}), 2);
    clock.set_speed(kBegin + seconds{4}, 4);
    EXPECT_EQ(clock.time_s(kBegin + seconds{4}), 2);
    EXPECT_EQ(clock.time_s(kBegin + seconds{5}), 6);
}

TEST(ReplayClock, PausesAndSeeks) {
    ReplayClock clock(10);
    clock.resume(kBegin);
    clock.pause(kBegin + seconds{3});
    EXPECT_EQ(clock.time_s(kBegin + seconds{9}), 3);
    clock.seek(kBegin + seconds{9}, 7);
    EXPECT_FALSE(clock.running());
    EXPECT_EQ(clock.time_s(kBegin + seconds{20}), 7);
    clock.resume(kBegin + seconds{20});
    EXPECT_EQ(clock.time_s(kBegin + seconds{21}), 8);
    clock.seek(kBegin + seconds{21}, 1);
    EXPECT_EQ(clock.time_s(kBegin + seconds{22}), 2);
}

TEST(ReplayClock, EndsAtTheEnds) {
    ReplayClock clock(10);
    clock.resume(kBegin);
    EXPECT_TRUE(clock.at_end(kBegin + seconds{11}));
    EXPECT_EQ(clock.time_s(kBegin + seconds{99}), 10);
    clock.seek(kBegin + seconds{99}, -4);
    EXPECT_EQ(clock.time_s(kBegin + seconds{99}), 0);
    clock.seek(kBegin + seconds{99}, 400);
    EXPECT_EQ(clock.time_s(kBegin + seconds{99}), 10);
    ReplayClock still(0);
    still.resume(kBegin);
    EXPECT_TRUE(still.at_end(kBegin));
    EXPECT_EQ(ReplayClock(1, 1e9).speed(), ReplayClock::kFastest);
}

TEST(ReplayClock, NeverLeavesTheRecordingNorGoesBackByItself) {
    EXPECT_TRUE(rc::check([] {
        ReplayClock clock(*rc::gen::inRange(0, 100));
        SessionTime now = kBegin;
        double before_s = 0;
        for (int i = 0; i < 50; ++i) {
            now += milliseconds{*rc::gen::inRange(0, 3000)};
            RC_ASSERT(clock.time_s(now) >= before_s);
            switch (*rc::gen::inRange(0, 4)) {
                case 0:
                    clock.pause(now);
                    break;
                case 1:
                    clock.resume(now);
                    break;
                case 2:
                    clock.set_speed(now, *rc::gen::inRange(1, 2000) * 0.1);
                    break;
                default:
                    clock.seek(now, *rc::gen::inRange(-10, 120));
            }
            before_s = clock.time_s(now);
            RC_ASSERT(before_s >= 0 && before_s <= 100);
        }
    }));
}

}  // namespace
}  // namespace thimble
