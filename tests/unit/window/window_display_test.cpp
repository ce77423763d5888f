#include "visual_node/window/window_display.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

Scene stamped(std::int64_t i) { return {.sample_time = from_nanoseconds(i)}; }

TEST(WindowDisplay, TellsThePresentedWhenLightLeaves) {
    WindowDisplay display(milliseconds{10});
    EXPECT_EQ(display.next_shown(), kNever);
    display.draw(at(milliseconds{1}), stamped(1));
    const auto taken = display.take_scene();
    ASSERT_TRUE(taken);
    display.presented(*taken, at(milliseconds{5}));
    EXPECT_EQ(display.next_shown(), at(milliseconds{15}));
    EXPECT_FALSE(display.shown(at(milliseconds{14})));
    const auto shown = display.shown(at(milliseconds{15}));
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->shown_at, at(milliseconds{15}));
    EXPECT_EQ(shown->scene.sample_time, from_nanoseconds(1));
}

TEST(WindowDisplay, CountsWhatNobodySees) {
    WindowDisplay display(Duration::zero());
    for (int i = 0; i < 1100; ++i) display.draw({}, stamped(i));  // hangs
    EXPECT_EQ(display.unseen(), 76U);
    EXPECT_EQ(display.take_scene().value().sample_time, from_nanoseconds(0));
    display.draw({}, stamped(5000));  // there is room again
    EXPECT_EQ(display.unseen(), 76U);
    display.close();
    display.draw({}, stamped(5001));
    EXPECT_EQ(display.unseen(), 77U);
}

TEST(WindowDisplay, PassesPagesAndBeepsOn) {
    WindowDisplay display(Duration::zero());
    display.turn_page({}, {.kind = PageKind::kReady});
    display.beep(at(milliseconds{3}));
    EXPECT_EQ(display.take_page().value().kind, PageKind::kReady);
    EXPECT_FALSE(display.take_page());
    EXPECT_EQ(display.take_beep(), at(milliseconds{3}));
    EXPECT_FALSE(display.take_beep());
}

TEST(WindowDisplay, PassesAnswersOnInTheirOrder) {
    WindowDisplay display(Duration::zero());
    EXPECT_FALSE(display.take_answer());
    display.answer({3, 50});
    display.answer({4, 1});
    EXPECT_EQ(display.take_answer().value().question, 3U);
    EXPECT_EQ(display.take_answer().value().value, 1);
    EXPECT_FALSE(display.take_answer());
}

// A window that hangs while many pages are turned shows the newest one when it looks again.
TEST(WindowDisplay, TheNewestPageIsNeverLost) {
    WindowDisplay display(Duration::zero());
    for (int i = 0; i < 1000; ++i) display.turn_page({}, {.kind = PageKind::kBreak});
    display.turn_page({}, Page{});  // a trial begins
    const auto newest = [&] {
        PageKind kind = PageKind::kWait;
        while (const auto taken = display.take_page()) kind = taken->kind;
        return kind;
    };
    EXPECT_EQ(newest(), PageKind::kBreak);
    display.shown({});  // the node's next tick
    EXPECT_EQ(newest(), PageKind::kNone);
    display.shown({});
    EXPECT_FALSE(display.take_page()) << "and only once";
}

}  // namespace
}  // namespace thimble
