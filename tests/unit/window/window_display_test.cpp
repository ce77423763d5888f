#include "visual_node/window/window_display.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

Scene stamped(std::int64_t i) {
    Scene scene;
    scene.sample_time = from_nanoseconds(i);
    return scene;
}

TEST(SpscRing, HoldsWhatItWasMadeForAndNoMore) {
    SpscRing<int> ring(2);
    EXPECT_EQ(ring.front(), nullptr);
    EXPECT_TRUE(ring.push(1));
    EXPECT_TRUE(ring.push(2));
    EXPECT_FALSE(ring.push(3));
    EXPECT_EQ(*ring.front(), 1);
    ring.pop();
    EXPECT_TRUE(ring.push(3));
    ring.pop();
    EXPECT_EQ(*ring.front(), 3);
}

TEST(SpscRing, LosesNothingBetweenTwoThreads) {
    constexpr int kMany = 200'000;
    SpscRing<int> ring(64);
    std::thread giver([&] {
        for (int i = 0; i < kMany; ++i) {
            while (!ring.push(i)) std::this_thread::yield();
        }
    });
    int wrong = 0;
    for (int i = 0; i < kMany; ++i) {
        while (ring.front() == nullptr) std::this_thread::yield();
        wrong += *ring.front() == i ? 0 : 1;
        ring.pop();
    }
    giver.join();
    EXPECT_EQ(wrong, 0);
}

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
    Page page;
    page.kind = PageKind::kReady;
    display.turn_page({}, page);
    display.beep(at(milliseconds{3}));
    EXPECT_EQ(display.take_page().value().kind, PageKind::kReady);
    EXPECT_FALSE(display.take_page());
    EXPECT_EQ(display.take_beep(), at(milliseconds{3}));
    EXPECT_FALSE(display.take_beep());
}

// A window that hangs while many pages are turned shows the newest one when it looks again.
TEST(WindowDisplay, TheNewestPageIsNeverLost) {
    WindowDisplay display(Duration::zero());
    Page page;
    page.kind = PageKind::kBreak;
    for (int i = 0; i < 1000; ++i) display.turn_page({}, page);
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
