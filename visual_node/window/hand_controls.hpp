// Arrow keys and a gamepad as the hand of a window, and the gamepad's motors as its fingers.
#pragma once

#include <optional>

#include "visual_node/display.hpp"
#include "visual_node/gamepad/vibration.hpp"
#include "visual_node/window/gl_window.hpp"
#include "visual_node/window/pointer_hand.hpp"

namespace thimble {

// The longest time that one reading stands for: after a hang a hand does not jump.
inline constexpr Duration kLongestWait = std::chrono::milliseconds{10};

class HandControls {
  public:
    // Both may be null, and outlive this: nothing moves the hand; nothing vibrates.
    HandControls(PointerHand* hand, Vibration* vibration) : hand_(hand), vibration_(vibration) {}

    // A key that is no arrow changes nothing. The first press takes the needle; it stays in the hand until Esc.
    void hold_arrow(const WindowEvent& event);
    void release_arrow() { arrow_ = 0; }
    // Moves the hand. Whether the gamepad took the needle with this reading.
    bool read(SessionTime now);
    void vibrate(SessionTime now, const std::optional<Scene>& scene);

  private:
    bool read_gamepad(SessionTime now);
    void push_by_arrows(SessionTime now);

    PointerHand* hand_;
    Vibration* vibration_;
    int gamepad_ = 0;            // GLFW's number of it, until it is pulled out
    JoystickIdentity joystick_;  // the same; no name: there is none
    SessionTime stick_read_{}, arrow_since_{}, arrow_read_{};
    int arrow_ = 0;  // the arrow key that is held: 1 into the tissue, -1 out
    bool stick_held_ = false;
};

}  // namespace thimble
