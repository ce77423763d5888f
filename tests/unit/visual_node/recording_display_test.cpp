#include "visual_node/recording_display.hpp"

#include <gtest/gtest.h>

#include "tests/allocation_count.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

Scene scene(double bar_N) { return {.bar_N = bar_N}; }

TEST(RecordingDisplay, ShowsAfterThePipeline) {
    RecordingDisplay display(milliseconds{25});
    EXPECT_EQ(display.next_shown(), kNever);
    display.draw(at(milliseconds{10}), scene(1));
    EXPECT_EQ(display.next_shown(), at(milliseconds{35}));
    EXPECT_FALSE(display.shown(at(milliseconds{35} - Duration{1})).has_value());
    const auto shown = display.shown(at(milliseconds{36}));
    ASSERT_TRUE(shown.has_value());
    EXPECT_EQ(shown->shown_at, at(milliseconds{35}));
    EXPECT_EQ(shown->scene.bar_N, 1);
    EXPECT_FALSE(display.shown(at(milliseconds{36})).has_value());
    EXPECT_EQ(display.next_shown(), kNever);
}

TEST(RecordingDisplay, RemembersTheLastFramesWithoutAllocating) {
    RecordingDisplay display({}, 8);
    const std::uint64_t before = test::allocation_count();
    for (int i = 0; i < 100; ++i) {
        display.draw(at(milliseconds{i}), scene(i));
        display.shown(at(milliseconds{i}));
    }
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(display.shown_total(), 100U);
    ASSERT_EQ(display.remembered(), 8U);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(display.recent(i).scene.bar_N, 99 - static_cast<int>(i));
    // A frame on its way takes the place of the oldest.
    display.draw(at(milliseconds{100}), scene(100));
    EXPECT_EQ(display.remembered(), 7U);
    EXPECT_EQ(display.recent(0).scene.bar_N, 99);
}

TEST(RecordingDisplay, ShowsEachFrameOnceOldestFirstAndDropsWhatItCannotHold) {
    RecordingDisplay display(milliseconds{25}, 2);
    for (int i = 0; i < 3; ++i) display.draw(at(milliseconds{i}), scene(i));
    EXPECT_EQ(display.dropped_total(), 1U);
    EXPECT_EQ(display.remembered(), 0U);
    for (int i = 0; i < 2; ++i) {
        const auto shown = display.shown(at(milliseconds{50}));
        ASSERT_TRUE(shown.has_value());
        EXPECT_EQ(shown->scene.bar_N, i);
        EXPECT_EQ(shown->shown_at, at(milliseconds{25 + i}));
    }
    EXPECT_FALSE(display.shown(at(milliseconds{50})).has_value());
    EXPECT_EQ(display.shown_total(), 2U);
}

TEST(RecordingDisplay, HasRoomForAllThatASlowScreenHasOnItsWay) {
    VisualSettings fast;
    fast.refresh_Hz = 1000;
    fast.pipeline = std::chrono::seconds{1};
    RecordingDisplay display(fast);
    for (int i = 0; i < 1000; ++i) display.draw(at(milliseconds{i}), scene(i));
    EXPECT_EQ(display.dropped_total(), 0U);
}

}  // namespace
}  // namespace thimble
