// Which /dev/input/eventN is the joystick that GLFW has opened: GLFW does not say, so name and identity decide.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace thimble {

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

}  // namespace thimble
