#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"
#include "visual_node/window/frame_times.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A monitor that refreshes every 10 ms and lets swaps return then; drawing takes `draw`.
struct Monitor100 {
    FramePace pace{100};
    SessionTime swapped = at(milliseconds{0});
    SessionTime begun = swapped;
    int missed = 0;

    void frames(int count, Duration draw) {
        for (int i = 0; i < count; ++i) {
            const SessionTime last = swapped;
            begun = std::max(pace.next(begun, swapped), swapped);
            const Duration ready = begun + draw - SessionTime{};
            const auto refresh = (ready + milliseconds{10} - Duration{1}) / milliseconds{10};
            swapped = at(milliseconds{10 * refresh});
            if (i > 20 && swapped - last > milliseconds{10}) ++missed;
        }
    }
};

TEST(FramePace, BeginsLateAndMissesNoRefresh) {
    Monitor100 monitor;
    monitor.frames(500, milliseconds{2});
    EXPECT_EQ(monitor.missed, 0);
    EXPECT_EQ(monitor.swapped - monitor.begun, milliseconds{4});
}

TEST(FramePace, GivesSlowDrawingMoreTime) {
    Monitor100 monitor;
    monitor.frames(500, milliseconds{7});
    EXPECT_EQ(monitor.missed, 0);
    EXPECT_EQ(monitor.pace.budget(), milliseconds{8});
}

TEST(FramePace, TakesTimeBackAfterLongQuiet) {
    Monitor100 monitor;
    monitor.frames(30, milliseconds{9});
    const Duration most = monitor.pace.budget();
    EXPECT_GT(most, milliseconds{8});
    monitor.frames(610, milliseconds{1});
    EXPECT_EQ(monitor.pace.budget(), most - most / 8) << "after 600 quiet frames";
    monitor.frames(6000, milliseconds{1});
    EXPECT_LT(monitor.pace.budget(), milliseconds{6});
}

TEST(FramePace, KeepsItsRateWithoutAMonitorHoweverLongDrawingTakes) {
    for (const Duration draw : {milliseconds{1}, milliseconds{5}, milliseconds{7}, milliseconds{9}}) {
        FramePace pace(100);
        SessionTime begun = at(milliseconds{0});
        for (int i = 0; i < 1000; ++i) begun = std::max(pace.next(begun, begun + draw), begun + draw);
        EXPECT_GE(begun, at(milliseconds{9700})) << to_seconds(draw);
        EXPECT_LE(begun, at(milliseconds{draw == milliseconds{1} ? 10'000 : 10'250})) << to_seconds(draw);
    }
}

// By the hand, at the slave, here; `hand_ms` 0: there is none.
Scene stamped(int hand_ms, int answer_ms, int sample_ms) {
    Scene scene;
    if (hand_ms > 0) scene.hand_time = at(milliseconds{hand_ms});
    scene.answer_time = at(milliseconds{answer_ms});
    scene.sample_time = at(milliseconds{sample_ms});
    return scene;
}

TEST(FrameTimes, CountsNewSamplesByStageAndFramesByInterval) {
    FrameTimes times(true);
    const Scene scene = stamped(100, 101, 103);
    times.add(scene, at(milliseconds{110}), at(milliseconds{115}));
    times.add(scene, at(milliseconds{120}), at(milliseconds{125}));
    EXPECT_EQ(times.hand_to_slave.worst(), milliseconds{1});
    EXPECT_EQ(times.slave_to_arrival.worst(), milliseconds{2});
    EXPECT_EQ(times.arrival_to_frame.worst(), milliseconds{7});
    EXPECT_EQ(times.hand_to_swap.worst(), milliseconds{15});
    EXPECT_EQ(times.hand_to_swap.count(), 1U);
    EXPECT_EQ(times.draw.count(), 2U);
    EXPECT_EQ(times.interval.worst(), milliseconds{10});
}

TEST(FrameTimes, SaysNothingAboutOtherMachinesClocksAndAHandThatAReplayHasNot) {
    for (const bool one_clock : {false, true}) {
        FrameTimes times(one_clock);
        times.add(one_clock ? stamped(0, 2, 3) : stamped(900, 900, 3), at(milliseconds{10}),
                  at(milliseconds{15}));
        EXPECT_EQ(times.hand_to_swap.count() + times.hand_to_slave.count() + times.slave_to_arrival.count(),
                  0U);
        EXPECT_EQ(times.arrival_to_frame.worst(), milliseconds{7});
    }
}

}  // namespace
}  // namespace thimble
