#include "visual_node/window/window_loop.hpp"

#include <atomic>
#include <imgui.h>
#include <thread>

#include <gmock/gmock.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/window/x_server.hpp"

// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

// GLFW's gamepad, played by the test: the program's own definitions come before those of the library.
static bool gamepad_plugged = false, gamepad_held = false;
extern "C" int glfwJoystickIsGamepad(int jid) {
    return gamepad_plugged && jid == GLFW_JOYSTICK_1 ? GLFW_TRUE : GLFW_FALSE;
}
extern "C" int glfwGetGamepadState(int jid, GLFWgamepadstate* state) {
    *state = {};
    state->buttons[GLFW_GAMEPAD_BUTTON_A] = gamepad_held ? GLFW_PRESS : GLFW_RELEASE;
    return glfwJoystickIsGamepad(jid);
}

namespace thimble {
namespace {

using std::chrono::milliseconds;

class WindowLoopTest : public WithXServer {
  protected:
    // A person's keys and mouse, by xdotool.
    bool person(WindowLoop& loop, const std::vector<std::string>& words) const {
        Child tool("xdotool", words, server_.folder() / "xdotool");
        for (int i = 0; i < 200 && !tool.poll(); ++i) loop.turn();  // who moves waits for who shows
        return tool.poll() == 0;
    }
};

Scene scene_at(SessionTime arrived) {
    Scene scene;
    scene.position_surface_m = scene.position_surface_rest_m = 0.02;
    scene.sample_time = arrived;
    scene.hand_time = arrived - milliseconds{3};
    scene.answer_time = arrived - milliseconds{2};
    return scene;
}

struct CountingOverlay final : Overlay {
    void tick(SessionTime) override { ++ticks; }
    void draw(SessionTime, const OverlayFrame& frame) override {
        ++draws;
        has_times |= frame.times != nullptr;
        ImGui::TextUnformatted("panel");
    }
    void closing(SessionTime) override { told_of_end = true; }
    int ticks = 0, draws = 0;
    bool has_times = false, told_of_end = false;
};

TEST_F(WindowLoopTest, ShowsTheNewestSceneAndSaysWhen) {
    GlWindow window{WindowSettings{}};
    WindowDisplay display(milliseconds{7});
    CountingOverlay overlay;
    WindowLoop loop({&window, &display, nullptr, &overlay}, Duration::zero(), true);
    const SessionTime before = wall_now();
    display.draw(before, scene_at(before - milliseconds{2}));
    display.draw(before, scene_at(before - milliseconds{1}));
    ASSERT_TRUE(loop.turn());
    const auto shown = display.shown(kNever - Duration{1});
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->scene.sample_time, before - milliseconds{1});
    EXPECT_GE(shown->shown_at, before + milliseconds{7});
    EXPECT_LE(shown->shown_at, wall_now() + milliseconds{7});
    EXPECT_FALSE(display.shown(kNever - Duration{1}));
    EXPECT_EQ(loop.times().hand_to_swap.count(), 1U);
    EXPECT_EQ(loop.times().hand_to_slave.worst(), milliseconds{1});
    EXPECT_EQ(loop.times().slave_to_arrival.worst(), milliseconds{2});
    EXPECT_GE(loop.times().arrival_to_frame.worst(), milliseconds{1});
    EXPECT_EQ(overlay.draws, 1);
    EXPECT_GE(overlay.ticks, 1);
    EXPECT_TRUE(overlay.has_times);
}

TEST_F(WindowLoopTest, DrawsFrameAfterFrameUntilItIsTold) {
    GlWindow window{WindowSettings{}};
    WindowDisplay display(Duration::zero());
    WindowLoop loop({&window, &display}, Duration::zero(), true);
    const SessionTime end = wall_now() + milliseconds{700};
    EXPECT_EQ(loop.run([&] { return wall_now() >= end; }), WindowEnd::kAsked);
    EXPECT_GT(loop.frames(), 5U);
    EXPECT_LT(loop.frames(), 80U);  // its own pace, where no monitor gives one
}

TEST_F(WindowLoopTest, PageCoversTheSceneUntilTheTrial) {
    GlWindow window{WindowSettings{}};
    WindowDisplay display(Duration::zero());
    WindowLoop loop({&window, &display}, Duration::zero(), true);
    display.draw({}, scene_at(wall_now()));
    const Image scene = loop.picture();
    Page page;
    page.kind = PageKind::kBreak;
    page.remaining_s = 61;
    display.turn_page({}, page);
    const Image covered = loop.picture();
    EXPECT_EQ(covered.at(400, 580), colours::kBackground);
    int ink = 0;
    for (int y = 150; y < 350; ++y) {
        for (int x = 0; x < 800; ++x) ink += covered.at(x, y) != colours::kBackground ? 1 : 0;
    }
    EXPECT_GT(ink, 300);
    EXPECT_LT(ink, 20000);
    display.turn_page({}, Page{});
    EXPECT_EQ(loop.picture().rgb, scene.rgb);
}

TEST_F(WindowLoopTest, ReportsBeepsAlsoWithoutSound) {
    GlWindow window{WindowSettings{}};
    WindowDisplay display(Duration::zero());
    WindowLoop loop({&window, &display}, Duration::zero(), true);
    const SessionTime asked = wall_now();
    display.beep(asked);
    ASSERT_TRUE(loop.turn());
    ASSERT_EQ(loop.beeps().size(), 1U);
    EXPECT_EQ(loop.beeps()[0].asked, asked);
    EXPECT_GE(loop.beeps()[0].begun, asked);
}

TEST_F(WindowLoopTest, ClosedWindowEndsTheLoopAndNotTheNode) {
    GlWindow window{WindowSettings{}};
    WindowDisplay display(Duration::zero());
    CountingOverlay overlay;
    WindowLoop loop({&window, &display, nullptr, &overlay}, Duration::zero(), true);
    ASSERT_TRUE(loop.turn());
    glfwSetWindowShouldClose(window.handle(), GLFW_TRUE);  // what a click on the frame's cross does
    EXPECT_EQ(loop.run([] { return false; }), WindowEnd::kClosed);
    EXPECT_TRUE(overlay.told_of_end);
    display.draw({}, Scene{});
    EXPECT_EQ(display.unseen(), 1U);
}

TEST_F(WindowLoopTest, MouseTakesTheHandMovesItAndLetsGo) {
    WindowSettings settings;
    settings.title = "hand under test";
    GlWindow window{settings};
    WindowDisplay display(Duration::zero());
    PointerHand hand(1e-4);
    WindowLoop loop({&window, &display, &hand}, Duration::zero(), true);
    if (!person(loop, {"version"})) GTEST_SKIP() << "xdotool is not installed (deploy/packages.txt, [test])";
    ASSERT_TRUE(person(loop, {"search", "--name", "hand under test", "windowfocus"}));
    ASSERT_TRUE(
        person(loop, {"search", "--name", "hand under test", "mousemove", "--window", "%1", "400", "300"}));
    EXPECT_FALSE(hand.hand().engaged);
    ASSERT_TRUE(person(loop, {"click", "1"}));
    for (int i = 0; i < 20; ++i) loop.turn();
    EXPECT_TRUE(hand.hand().engaged);
    const double before_m = hand.hand().position_hand_m;
    ASSERT_TRUE(person(loop, {"mousemove_relative", "0", "60"}));
    for (int i = 0; i < 20; ++i) loop.turn();
    EXPECT_NEAR(hand.hand().position_hand_m - before_m, 60e-4, 30e-4);
    ASSERT_TRUE(person(loop, {"key", "Escape"}));
    for (int i = 0; i < 20; ++i) loop.turn();
    EXPECT_FALSE(hand.hand().engaged);
}

TEST_F(WindowLoopTest, AGamepadThatIsPulledOutWhileItHoldsLetsGo) {
    GlWindow window{WindowSettings{}};
    WindowDisplay display(Duration::zero());
    PointerHand hand(1e-4);
    WindowLoop loop({&window, &display, &hand}, Duration::zero(), true);
    const auto engaged_when = [&](bool plugged, bool held) {
        gamepad_plugged = plugged;
        gamepad_held = held;
        loop.turn();
        return hand.hand().engaged;
    };
    EXPECT_FALSE(engaged_when(true, false));
    EXPECT_TRUE(engaged_when(true, true));
    EXPECT_FALSE(engaged_when(false, true));
    EXPECT_TRUE(engaged_when(true, true)) << "plugged in again, and held";
    EXPECT_FALSE(engaged_when(true, false));
    hand.take_hold();  // by the mouse
    EXPECT_TRUE(engaged_when(false, false)) << "no gamepad is no reason to let go of the mouse";
}

TEST_F(WindowLoopTest, BackspaceIsAnEmergencyStopOnce) {
    WindowSettings settings;
    settings.title = "stop under test";
    GlWindow window{settings};
    WindowDisplay display(Duration::zero());
    WindowLoop loop({&window, &display}, Duration::zero(), true);
    if (!person(loop, {"version"})) GTEST_SKIP() << "xdotool is not installed (deploy/packages.txt, [test])";
    ASSERT_TRUE(person(loop, {"search", "--name", "stop under test", "windowfocus"}));
    ASSERT_TRUE(person(loop, {"key", "space"}));
    for (int i = 0; i < 10; ++i) loop.turn();
    EXPECT_FALSE(display.take_stop());
    ASSERT_TRUE(person(loop, {"key", "BackSpace"}));
    for (int i = 0; i < 20; ++i) loop.turn();
    EXPECT_TRUE(display.take_stop());
    EXPECT_FALSE(display.take_stop());
}

TEST_F(WindowLoopTest, NodeGoesOnWithoutScreen) {
    EXPECT_EXIT(
        {
            GlWindow window{WindowSettings{}};
            WindowDisplay display(Duration::zero());
            WindowLoop loop({&window, &display}, Duration::zero(), true);
            std::atomic<bool> stop{false};
            std::uint64_t taken = 0;
            std::thread node([&] {
                for (int i = 0; i < 1500; ++i) {
                    const SessionTime now = wall_now();
                    display.draw(now, scene_at(now));
                    while (display.shown(now)) ++taken;
                    if (i == 500) server_.kill();
                    wall_sleep(milliseconds{1});
                }
                stop = true;
            });
            const WindowEnd end = loop.run([&] { return stop.load(); });
            const bool before_node = !stop;
            node.join();
            const bool good =
                end == WindowEnd::kScreenLost && before_node && taken > 0 && display.unseen() > 0;
            std::_Exit(good ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace thimble
