#include "visual_node/window/window_loop.hpp"

#include <atomic>
#include <imgui.h>
#include <thread>
#include <utility>

#include <gmock/gmock.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/window/image.hpp"

// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

namespace thimble {
namespace {

using std::chrono::milliseconds;

class WindowLoopTest : public OnAScreen {
  protected:
    // A person's keys and mouse, by xdotool.
    bool person(WindowLoop& loop, const std::vector<std::string>& words) const {
        Child tool("xdotool", words, screen_->folder() / "xdotool");
        const SessionTime end = wall_now() + kPatience;
        while (!tool.poll() && wall_now() < end) loop.turn();  // who moves waits for who shows
        return tool.poll() == 0;
    }
};

// A window that shows what its display is given.
struct Shown {
    explicit Shown(const std::string& title = "Thimble", PointerHand* hand = nullptr,
                   Overlay* overlay = nullptr, Duration light = {})
        : window(titled(title)),
          display(light),
          loop({&window, &display, hand, overlay}, Duration::zero(), true) {}
    static WindowSettings titled(const std::string& title) { return {.title = title}; }
    void turns(int count) {
        for (int i = 0; i < count; ++i) loop.turn();
    }

    GlWindow window;
    WindowDisplay display;
    WindowLoop loop;
};

Scene scene_at(SessionTime arrived) {
    return {.position_surface_m = 0.02,
            .sample_time = arrived,
            .position_surface_rest_m = 0.02,
            .hand_time = arrived - milliseconds{3},
            .answer_time = arrived - milliseconds{2}};
}

struct CountingOverlay final : Overlay {
    void tick(SessionTime) override { ++ticks; }
    void draw(SessionTime, const OverlayFrame& frame) override {
        ++draws;
        has_times |= frame.times != nullptr;
        hand_holds = frame.hand_holds;
        ImGui::TextUnformatted("panel");
    }
    void closing(SessionTime) override { told_of_end = true; }
    int ticks = 0, draws = 0;
    bool has_times = false, told_of_end = false;
    std::optional<bool> hand_holds;
};

TEST_F(WindowLoopTest, ShowsTheNewestSceneAndSaysWhen) {
    CountingOverlay overlay;
    Shown shown("Thimble", nullptr, &overlay, milliseconds{7});
    const SessionTime before = wall_now();
    shown.display.draw(before, scene_at(before - milliseconds{2}));
    shown.display.draw(before, scene_at(before - milliseconds{1}));
    ASSERT_TRUE(shown.loop.turn());
    const auto seen = shown.display.shown(kNever - Duration{1});
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->scene.sample_time, before - milliseconds{1});
    EXPECT_GE(seen->shown_at, before + milliseconds{7});
    EXPECT_LE(seen->shown_at, wall_now() + milliseconds{7});
    EXPECT_FALSE(shown.display.shown(kNever - Duration{1}));
    EXPECT_EQ(shown.loop.times().hand_to_swap.count(), 1U);
    EXPECT_EQ(shown.loop.times().hand_to_slave.worst(), milliseconds{1});
    EXPECT_EQ(shown.loop.times().slave_to_arrival.worst(), milliseconds{2});
    EXPECT_GE(shown.loop.times().arrival_to_frame.worst(), milliseconds{1});
    EXPECT_EQ(overlay.draws, 1);
    EXPECT_GE(overlay.ticks, 1);
    EXPECT_TRUE(overlay.has_times);
}

TEST_F(WindowLoopTest, DrawsFrameAfterFrameUntilItIsTold) {
    Shown shown;
    const SessionTime begin = wall_now();
    const auto passed = [&] { return wall_now() - begin; };
    const auto told = [&] { return passed() >= milliseconds{700} && shown.loop.frames() > 5; };
    EXPECT_EQ(shown.loop.run([&] { return told() || passed() > kPatience; }), WindowEnd::kAsked);
    EXPECT_GT(shown.loop.frames(), 5U);
    // Its own pace, where no monitor gives one: less than 80 frames in 0.7 s.
    EXPECT_LT(static_cast<double>(shown.loop.frames()), 80 / 0.7 * to_seconds(passed()));
}

TEST_F(WindowLoopTest, PageCoversTheSceneUntilTheTrial) {
    Shown shown;
    shown.display.draw({}, scene_at(wall_now()));
    const Image scene = shown.loop.picture();
    shown.display.turn_page({}, {.remaining_s = 61, .kind = PageKind::kBreak});
    const Image covered = shown.loop.picture();
    EXPECT_EQ(covered.at(400, 580), colours::kBackground);
    int ink = 0;
    for (int y = 150; y < 350; ++y)
        for (int x = 0; x < 800; ++x) ink += covered.at(x, y) != colours::kBackground ? 1 : 0;
    EXPECT_GT(ink, 300);
    EXPECT_LT(ink, 20000);
    shown.display.turn_page({}, Page{});
    EXPECT_EQ(shown.loop.picture().rgb, scene.rgb);
}

TEST_F(WindowLoopTest, ReportsBeepsAlsoWithoutSound) {
    Shown shown;
    const SessionTime asked = wall_now();
    shown.display.beep(asked);
    ASSERT_TRUE(shown.loop.turn());
    ASSERT_EQ(shown.loop.beeps().size(), 1U);
    EXPECT_EQ(shown.loop.beeps()[0].asked, asked);
    EXPECT_GE(shown.loop.beeps()[0].begun, asked);
}

TEST_F(WindowLoopTest, ABeepIsSeenWhereItIsToBe) {
    GlWindow window(Shown::titled("Thimble"));
    WindowDisplay display(Duration::zero());
    WindowLoop::Parts parts{&window, &display};
    parts.beep_shown = true;
    WindowLoop loop(parts, Duration::zero(), true);
    const Image before = loop.picture();
    display.beep(wall_now());
    const Image seen = loop.picture();
    int changed = 0;
    for (int y = 0; y < window.height(); ++y) changed += seen.at(8, y) != before.at(8, y) ? 1 : 0;
    EXPECT_GT(changed, window.height() / 2);
    wall_sleep(milliseconds{700});
    EXPECT_EQ(loop.picture().rgb, before.rgb) << "and then it is gone";
}

// A page set with one question, in a window that shows it.
struct Asking {
    explicit Asking(const std::string& kind, const std::string& text = "How?") {
        const ConfigFile file = ConfigFile::parse(
            "[[questionnaire]]\nname = 'q'\n[[questionnaire.question]]\nid = 'q'\ntext = \"\"\"" + text +
                "\"\"\"\n" + kind,
            "pages");
        file.read_all([&] { pages = read_page_set(file); });
        parts.pages = &pages;
        parts.hand = &hand;
        loop.emplace(parts, Duration::zero(), true);
        ask(pages.checksum());
    }
    // The first question of the page set with this checksum.
    void ask(std::uint32_t checksum) {
        display.turn_page({}, {.trial = 1, .trials = checksum, .kind = PageKind::kQuestion});
    }
    void turns(int count) {
        for (int i = 0; i < count; ++i) loop->turn();
    }
    PageSet pages;
    PointerHand hand{1e-4};
    GlWindow window{Shown::titled("question under test")};
    WindowDisplay display{Duration::zero()};
    WindowLoop::Parts parts{&window, &display};
    std::optional<WindowLoop> loop;
};

TEST_F(WindowLoopTest, AQuestionOfAnotherPageSetIsNotAnswered) {
    Asking asking("kind = 'likert'\n");
    asking.ask(asking.pages.checksum() + 1);  // the same number, and other words
    asking.turns(1);
    ASSERT_TRUE(person(*asking.loop,
                       {"search", "--name", "question under test", "windowfocus", "key", "5", "Return"}));
    asking.turns(20);
    EXPECT_FALSE(asking.display.take_answer());
}

TEST_F(WindowLoopTest, AQuestionIsAnsweredByKeys) {
    Asking asking("kind = 'likert'\n");
    WindowLoop& loop = *asking.loop;
    loop.turn();
    ASSERT_TRUE(person(loop, {"search", "--name", "question under test", "windowfocus", "key", "Return"}));
    loop.turn();
    EXPECT_FALSE(asking.display.take_answer()) << "nothing is chosen";
    ASSERT_TRUE(person(loop, {"key", "5", "Right", "Return"}));
    for (int i = 0; i < 20; ++i) loop.turn();
    const auto given = asking.display.take_answer();
    ASSERT_TRUE(given);
    EXPECT_EQ(given->question, 1U);
    EXPECT_EQ(given->value, 6);
}

TEST_F(WindowLoopTest, BackspaceClearsANumberAndElseStops) {
    for (const bool number : {true, false}) {
        Asking asking(number ? "kind = 'number'\n" : "kind = 'likert'\n");
        WindowLoop& loop = *asking.loop;
        for (int i = 0; i < 4; ++i) loop.turn();
        ASSERT_TRUE(person(loop, {"search", "--name", "question under test", "windowfocus", "key", "3",
                                  "BackSpace", "4", "Return"}));
        for (int i = 0; i < 20; ++i) loop.turn();
        EXPECT_EQ(asking.display.take_stop(), !number);
        const auto given = asking.display.take_answer();
        ASSERT_TRUE(given);
        EXPECT_EQ(given->value, 4);
    }
}

TEST_F(WindowLoopTest, ALongTextIsReadBeforeItIsAnswered) {
    std::string choices = "kind = 'choice'\nchoices = ['yes', '";
    for (int i = 0; i < 30; ++i) choices += "not at all ";
    std::string lines;
    for (int i = 1; i <= 60; ++i) lines += fmt::format("line {}\n", i);
    Asking asking(choices + "']\n", lines);
    WindowLoop& loop = *asking.loop;
    for (int i = 0; i < 4; ++i) loop.turn();
    ASSERT_TRUE(
        person(loop, {"search", "--name", "question under test", "windowfocus", "key", "1", "Return"}));
    for (int i = 0; i < 4; ++i) loop.turn();
    EXPECT_FALSE(asking.display.take_answer()) << "nobody has seen the end";
    ASSERT_TRUE(person(loop, {"key", "Next", "Next", "Next", "Next"}));
    for (int i = 0; i < 4; ++i) loop.turn();
    ASSERT_TRUE(person(loop, {"key", "Return"}));
    for (int i = 0; i < 4; ++i) loop.turn();
    EXPECT_TRUE(asking.display.take_answer());
}

TEST_F(WindowLoopTest, AQuestionIsAnsweredByTheMouse) {
    Asking asking("step = 5\n");
    WindowLoop& loop = *asking.loop;
    for (int i = 0; i < 3; ++i) loop.turn();
    std::optional<GivenAnswer> given;
    // Somewhere in the middle of the window is the scale, and below it OK.
    for (int y = 200; y < 420 && !given; y += 12) {
        for (const int x : {120, 500}) {
            person(loop, {"search", "--name", "question under test", "mousemove", "--window", "%1",
                          std::to_string(x), std::to_string(y), "click", "1"});
            for (int i = 0; i < 4; ++i) loop.turn();
            given = asking.display.take_answer();
            if (given) break;
        }
    }
    ASSERT_TRUE(given);
    EXPECT_GT(given->value, 50);
    EXPECT_FALSE(asking.hand.hand().engaged) << "a click at an answer takes no needle";
}

TEST_F(WindowLoopTest, ArrowKeysPushAndTheMouseDoesNot) {
    GlWindow window(Shown::titled("keys under test"));
    WindowDisplay display(Duration::zero());
    PointerHand hand(1e-4);
    CountingOverlay panel;  // at the left
    WindowLoop::Parts parts{&window, &display, &hand, &panel};
    parts.hand_kind = HandKind::kKeyboard;
    WindowLoop loop(parts, Duration::zero(), true);
    ASSERT_TRUE(person(loop, {"search", "--name", "keys under test", "windowfocus", "mousemove", "--window",
                              "%1", "600", "300", "click", "1"}));
    for (int i = 0; i < 10; ++i) loop.turn();
    EXPECT_FALSE(hand.hand().engaged);
    ASSERT_TRUE(person(loop, {"keydown", "Down"}));
    const auto moves = [&](bool inwards) {
        const double from_m = hand.hand().position_hand_m;
        for (int i = 0; i < 30; ++i) loop.turn();
        const double way_m = hand.hand().position_hand_m - from_m;
        return inwards ? way_m > 1e-4 : way_m == 0;
    };
    EXPECT_TRUE(moves(true));
    EXPECT_TRUE(hand.hand().engaged);
    // While the mouse holds the panel, ImGui wants every key.
    ASSERT_TRUE(person(loop, {"search", "--name", "keys under test", "mousemove", "--window", "%1", "200",
                              "200", "mousedown", "1"}));
    for (int i = 0; i < 10; ++i) loop.turn();
    ASSERT_TRUE(ImGui::GetIO().WantCaptureKeyboard);
    ASSERT_TRUE(person(loop, {"keyup", "Down", "key", "BackSpace"}));
    for (int i = 0; i < 10; ++i) loop.turn();
    EXPECT_TRUE(display.take_stop());
    EXPECT_TRUE(moves(false));
    EXPECT_TRUE(hand.hand().engaged) << "it holds the needle where it is";
    ASSERT_TRUE(person(loop, {"mouseup", "1", "key", "Escape"}));
    for (int i = 0; i < 10; ++i) loop.turn();
    EXPECT_FALSE(hand.hand().engaged);
}

TEST_F(WindowLoopTest, WhereADeviceIsTheHandThePointerHoldsNothing) {
    GlWindow window(Shown::titled("Thimble"));
    PointerHand hand(1e-4);
    CountingOverlay overlay;
    WindowLoop::Parts parts{&window, nullptr, &hand, &overlay};
    parts.hand_kind = HandKind::kDevice;
    ASSERT_TRUE(WindowLoop(parts, Duration::zero(), true).turn());
    EXPECT_FALSE(overlay.hand_holds.has_value());
}

TEST_F(WindowLoopTest, ClosedWindowEndsTheLoopAndNotTheNode) {
    CountingOverlay overlay;
    Shown shown("Thimble", nullptr, &overlay);
    ASSERT_TRUE(shown.loop.turn());
    shown.loop.set_screenshot(screen_->folder() / "last.png");
    glfwSetWindowShouldClose(shown.window.handle(), GLFW_TRUE);  // what a click on the frame's cross does
    EXPECT_EQ(shown.loop.run([] { return false; }), WindowEnd::kClosed);
    EXPECT_TRUE(overlay.told_of_end);
    EXPECT_EQ(read_png(screen_->folder() / "last.png").width, shown.window.width());
    shown.display.draw({}, Scene{});
    EXPECT_EQ(shown.display.unseen(), 1U);
}

TEST_F(WindowLoopTest, MouseTakesTheHandMovesItAndLetsGo) {
    PointerHand hand(1e-4);
    Shown shown("hand under test", &hand);
    ASSERT_TRUE(person(shown.loop, {"search", "--name", "hand under test", "windowfocus", "mousemove",
                                    "--window", "%1", "400", "300"}));
    EXPECT_FALSE(hand.hand().engaged);
    ASSERT_TRUE(person(shown.loop, {"click", "1"}));
    shown.turns(20);
    EXPECT_TRUE(hand.hand().engaged);
    const double before_m = hand.hand().position_hand_m;
    ASSERT_TRUE(person(shown.loop, {"mousemove_relative", "0", "60"}));
    shown.turns(20);
    EXPECT_NEAR(hand.hand().position_hand_m - before_m, 60e-4, 30e-4);
    ASSERT_TRUE(person(shown.loop, {"key", "Escape"}));
    shown.turns(20);
    EXPECT_FALSE(hand.hand().engaged);
}

TEST_F(WindowLoopTest, BackspaceIsAnEmergencyStopOnce) {
    Shown shown("stop under test");
    ASSERT_TRUE(person(shown.loop, {"search", "--name", "stop under test", "windowfocus", "key", "space"}));
    shown.turns(10);
    EXPECT_FALSE(shown.display.take_stop());
    ASSERT_TRUE(person(shown.loop, {"key", "BackSpace"}));
    shown.turns(20);
    EXPECT_TRUE(shown.display.take_stop());
    EXPECT_FALSE(shown.display.take_stop());
}

TEST_F(WindowLoopTest, NodeGoesOnWithoutScreen) {
    EXPECT_EXIT(
        {
            Shown shown;
            std::atomic<bool> ended{false};
            std::uint64_t taken = 0;
            const SessionTime limit = wall_now() + kPatience;
            std::thread node([&] {
                bool killed = false;
                for (int after = 0; after < 100 && wall_now() < limit;) {
                    const SessionTime now = wall_now();
                    shown.display.draw(now, scene_at(now));
                    while (shown.display.shown(now)) ++taken;
                    if (taken > 10 && !std::exchange(killed, true)) screen_->kill();
                    after += ended ? 1 : 0;  // turns without the window
                    wall_sleep(milliseconds{1});
                }
            });
            const WindowEnd end = shown.loop.run([&] { return wall_now() >= limit; });
            ended = true;
            node.join();
            std::_Exit(end == WindowEnd::kScreenLost && taken > 0 && shown.display.unseen() > 0 ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace thimble
