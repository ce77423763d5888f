// A gamepad's vibration in place of the fingertip devices: the motors of the pad that moves the hand, or of a device that the
// session file names. Belongs to the window's thread. A device that cannot vibrate gives one notice in the log, and no error.
#pragma once

#include <string>

#include "visual_node/gamepad/event_device.hpp"
#include "visual_node/gamepad/rumble_device.hpp"

namespace thimble {

class Vibration {
  public:
    // `device`: an event device; empty: that of the gamepad that is plugged in. `classes`: where the kernel lists them.
    explicit Vibration(std::string device, std::filesystem::path classes = "/sys/class/input");

    // The gamepad is this one from now on; an empty name: there is none any more. To be called once per change.
    void plugged(const JoystickIdentity& joystick);
    // The force on the fingers now, N.
    void feel(SessionTime now, double index_N, double thumb_N);
    // At once, whatever the pace.
    void stop();

    bool ready() const { return motors_.ready(); }
    const std::string& notice() const { return notice_; }

  private:
    void open(const std::string& event);
    void say(const std::string& notice);

    std::string device_;
    std::filesystem::path classes_;
    RumbleDevice motors_;
    RumblePace pace_;
    std::string notice_;
};

}  // namespace thimble
