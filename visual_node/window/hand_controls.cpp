#include "visual_node/window/hand_controls.hpp"

#include <algorithm>
#include <string>
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

namespace thimble {
namespace {

std::string text_of(const char* text) { return text == nullptr || *text == '\0' ? "gamepad" : text; }

// The joysticks before it may be a SpaceMouse or a wheel. The very first if there is no gamepad.
int first_gamepad() {
    for (int joystick = GLFW_JOYSTICK_1; joystick <= GLFW_JOYSTICK_LAST; ++joystick)
        if (glfwJoystickIsGamepad(joystick) == GLFW_TRUE) return joystick;
    return GLFW_JOYSTICK_1;
}

}  // namespace

void HandControls::hold_arrow(const WindowEvent& event) {
    if (hand_ == nullptr || event.repeated) return;
    const int way = event.key == GLFW_KEY_DOWN ? 1 : event.key == GLFW_KEY_UP ? -1 : 0;
    if (way == 0 || (!event.pressed && way != arrow_)) return;
    arrow_ = event.pressed ? way : 0;
    arrow_since_ = arrow_read_ = event.time;
    if (event.pressed) hand_->take_hold();
}

bool HandControls::read(SessionTime now) {
    if (hand_ == nullptr) return false;
    const bool taken = read_gamepad(now);
    push_by_arrows(now);
    return taken;
}

// A tap moves the hand a little; a held key moves it faster and faster.
void HandControls::push_by_arrows(SessionTime now) {
    if (arrow_ == 0) return;
    constexpr double kFirst = 0.2, kMore_per_s = 1.6;
    const double share = kFirst + kMore_per_s * to_seconds(now - arrow_since_);
    hand_->push(arrow_ * std::min(share, 1.0), std::clamp(now - arrow_read_, Duration{0}, kLongestWait));
    arrow_read_ = now;
}

bool HandControls::read_gamepad(SessionTime now) {
    const Duration since =
        stick_read_ == SessionTime{} ? Duration::zero() : std::min(now - stick_read_, kLongestWait);
    stick_read_ = now;
    GLFWgamepadstate state{};
    const bool there = glfwGetGamepadState(gamepad_, &state) == GLFW_TRUE;
    if (vibration_ != nullptr && there == joystick_.name.empty()) {
        joystick_ = there ? identity_of(text_of(glfwGetJoystickName(gamepad_)),
                                        text_of(glfwGetJoystickGUID(gamepad_)))
                          : JoystickIdentity{};
        vibration_->plugged(joystick_);
    }
    const bool held = there && state.buttons[GLFW_GAMEPAD_BUTTON_A] == GLFW_PRESS;
    const bool taken = held && !stick_held_;
    if (held != stick_held_) held ? hand_->take_hold() : hand_->let_go();
    stick_held_ = held;
    if (held) hand_->push(static_cast<double>(state.axes[GLFW_GAMEPAD_AXIS_LEFT_Y]), since);
    if (!there) gamepad_ = first_gamepad();  // for the next reading
    return taken;
}

void HandControls::vibrate(SessionTime now, const std::optional<Scene>& scene) {
    if (vibration_ == nullptr) return;
    vibration_->feel(now, scene ? scene->fingertip_N : 0, scene ? scene->thumb_N : 0);
}

}  // namespace thimble
