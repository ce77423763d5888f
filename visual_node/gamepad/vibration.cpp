#include "visual_node/gamepad/vibration.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace thimble {

Vibration::Vibration(std::string device, std::filesystem::path classes)
    : device_(std::move(device)), classes_(std::move(classes)) {
    if (!device_.empty()) open(device_);
}

void Vibration::open(const std::string& event) {
    motors_ = RumbleDevice(event);
    pace_.forget();
    if (ready()) {
        spdlog::info("the gamepad vibrates: {}", event);
    } else {
        say(motors_.notice());
    }
}

// The same one is not said twice: a pad with a loose cable would fill the log.
void Vibration::say(const std::string& notice) {
    if (notice == notice_) return;
    notice_ = notice;
    spdlog::warn(notice);
}

void Vibration::plugged(const JoystickIdentity& joystick) {
    if (!device_.empty() && ready()) return;
    motors_ = RumbleDevice();
    pace_.forget();
    if (joystick.name.empty()) return;
    if (!device_.empty()) return open(device_);
    if (const auto event = find_event_device(classes_, joystick)) return open(*event);
    say(fmt::format("the gamepad does not vibrate: '{}' has no motors that the kernel knows of",
                    joystick.name));
}

void Vibration::feel(SessionTime now, double index_N, double thumb_N) {
    if (!ready()) return;
    const auto levels = pace_.next(now, index_N, thumb_N);
    if (!levels) return;
    motors_.set(*levels);
    if (!ready()) say(motors_.notice());
}

void Vibration::stop() {
    motors_.set({});
    pace_.forget();
}

}  // namespace thimble
