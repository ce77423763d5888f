// A gamepad's vibration in place of the fingertip devices: the motors of the pad that moves the hand, or of a device that the
// session file names. Belongs to the window's thread. A device that cannot vibrate gives one notice in the log, and no error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "visual_node/gamepad/rumble.hpp"

namespace thimble {

// Which /dev/input/eventN is the joystick that GLFW has opened: GLFW does not say, so name and identity decide.
struct JoystickIdentity {
    std::string name;  // glfwGetJoystickName
    // Of USB or Bluetooth, as glfwGetJoystickGUID has them; both 0: not known.
    std::uint16_t vendor = 0, product = 0;

    bool operator==(const JoystickIdentity&) const = default;
};

// GLFW's (and SDL's) GUID: 32 hexadecimal digits; bus, vendor, product and version as words of 16 bits, low byte first, each
// followed by four zeros. Any other text: nothing is known but the name.
JoystickIdentity identity_of(std::string name, std::string_view guid);

// The first by name of the devices in `classes` (/sys/class/input) that are this joystick and can play force feedback; their
// files are in /dev/input. None: nullopt.
std::optional<std::string> find_event_device(const std::filesystem::path& classes,
                                             const JoystickIdentity& joystick);

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

    bool ready() const { return motors_ && motors_->ready(); }
    const std::string& notice() const { return notice_; }

  private:
    void open(const std::string& event);
    void say(const std::string& notice);

    std::string device_;
    std::filesystem::path classes_;
    std::optional<RumbleDevice> motors_;
    RumblePace pace_;
    std::string notice_;
};

}  // namespace thimble
