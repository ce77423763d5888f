// A gamepad as the hand of a window. No window is needed.
#include "visual_node/window/hand_controls.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

// GLFW's gamepads, played by the test: the program's own definitions come before those of the library.
static std::set<int> gamepads_plugged, gamepads_held;
extern "C" int glfwJoystickIsGamepad(int jid) {
    return gamepads_plugged.contains(jid) ? GLFW_TRUE : GLFW_FALSE;
}
extern "C" int glfwGetGamepadState(int jid, GLFWgamepadstate* state) {
    *state = {};
    state->buttons[GLFW_GAMEPAD_BUTTON_A] = gamepads_held.contains(jid) ? GLFW_PRESS : GLFW_RELEASE;
    return glfwJoystickIsGamepad(jid);
}

namespace thimble {
namespace {

class GamepadTest : public testing::Test {
  protected:
    ~GamepadTest() override { gamepads_plugged = gamepads_held = {}; }
    // After two readings: one finds the gamepad, the next one reads it.
    bool engaged_when(const std::set<int>& plugged, const std::set<int>& held) {
        gamepads_plugged = plugged;
        gamepads_held = held;
        for (int i = 0; i < 2; ++i) controls_.read(now_ += std::chrono::milliseconds{5});
        return hand_.hand().engaged;
    }

    PointerHand hand_{1e-4};

  private:
    HandControls controls_{&hand_, nullptr};
    SessionTime now_ = at(std::chrono::seconds{1});
};

TEST_F(GamepadTest, ThatIsPulledOutWhileItHoldsLetsGo) {
    EXPECT_FALSE(engaged_when({0}, {}));
    EXPECT_TRUE(engaged_when({0}, {0}));
    EXPECT_FALSE(engaged_when({}, {0}));
    EXPECT_TRUE(engaged_when({0}, {0})) << "plugged in again, and held";
    EXPECT_FALSE(engaged_when({0}, {}));
    hand_.take_hold();  // by the mouse
    EXPECT_TRUE(engaged_when({}, {})) << "no gamepad is no reason to let go of the mouse";
}

// A joystick before it, such as a SpaceMouse, is no gamepad.
TEST_F(GamepadTest, BehindAnotherJoystickIsTheHandAndStaysIt) {
    EXPECT_TRUE(engaged_when({2}, {2}));
    EXPECT_TRUE(engaged_when({1, 2}, {2})) << "a second gamepad takes nothing over";
    EXPECT_FALSE(engaged_when({1, 2}, {1}));
    EXPECT_TRUE(engaged_when({1}, {1})) << "the other one is pulled out";
}

}  // namespace
}  // namespace thimble
