#include "visual_node/gamepad/vibration.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/decimal_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

std::optional<unsigned> hexadecimal(std::string_view text) { return parse_whole<unsigned>(text, 16); }

// Low byte first; 0 if it is none.
std::uint16_t word_at(std::string_view guid, std::size_t digit) {
    const auto low = hexadecimal(guid.substr(digit, 2));
    const auto high = hexadecimal(guid.substr(digit + 2, 2));
    return low && high ? static_cast<std::uint16_t>(*low | *high << 8) : std::uint16_t{0};
}

// Words of bits, the highest first, "0" where there are none.
bool any_bit(const std::string& words) { return words.find_first_not_of("0 ") != std::string::npos; }

bool is_joystick(const fs::path& device, const JoystickIdentity& joystick) {
    if (!any_bit(first_line(device / "capabilities" / "ff"))) return false;
    if (first_line(device / "name") != joystick.name) return false;
    if (joystick.vendor == 0 && joystick.product == 0) return true;
    return hexadecimal(first_line(device / "id" / "vendor")) == joystick.vendor &&
           hexadecimal(first_line(device / "id" / "product")) == joystick.product;
}

}  // namespace

JoystickIdentity identity_of(std::string name, std::string_view guid) {
    JoystickIdentity identity{std::move(name)};
    const auto zeros = [guid](std::size_t digit) { return guid.substr(digit, 4) == "0000"; };
    if (guid.size() != 32 || !zeros(4) || !zeros(12) || !zeros(20)) return identity;
    identity.vendor = word_at(guid, 8);
    identity.product = word_at(guid, 16);
    return identity;
}

std::optional<std::string> find_event_device(const fs::path& classes, const JoystickIdentity& joystick) {
    std::error_code absent;
    std::vector<std::string> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(classes, absent)) {
        std::string name = entry.path().filename().string();
        if (name.rfind("event", 0) != 0 || !is_joystick(entry.path() / "device", joystick)) continue;
        found.push_back(std::move(name));
    }
    if (found.empty()) return std::nullopt;
    // GLFW opens devices in this order as well: of two of a kind, its first is the first here.
    return "/dev/input/" + *std::min_element(found.begin(), found.end());
}

Vibration::Vibration(std::string device, std::filesystem::path classes)
    : device_(std::move(device)), classes_(std::move(classes)) {
    if (!device_.empty()) open(device_);
}

void Vibration::open(const std::string& event) {
    motors_.emplace(event);
    pace_.forget();
    if (ready()) {
        spdlog::info("the gamepad vibrates: {}", event);
    } else {
        say(motors_->notice());
    }
}

// Logs a notice once: a pad with a loose cable would fill the log.
void Vibration::say(const std::string& notice) {
    if (notice == notice_) return;
    notice_ = notice;
    spdlog::warn(notice);
}

void Vibration::plugged(const JoystickIdentity& joystick) {
    if (!device_.empty() && ready()) return;
    motors_.reset();
    pace_.forget();
    if (joystick.name.empty()) return;
    if (!device_.empty()) return open(device_);
    if (const auto event = find_event_device(classes_, joystick)) return open(*event);
    say(fmt::format("the gamepad does not vibrate: the kernel finds no motors in '{}'", joystick.name));
}

void Vibration::feel(SessionTime now, double index_N, double thumb_N) {
    if (!ready()) return;
    const auto levels = pace_.next(now, index_N, thumb_N);
    if (!levels) return;
    motors_->set(*levels);
    if (!ready()) say(motors_->notice());
}

void Vibration::stop() {
    if (motors_) motors_->set({});
    pace_.forget();
}

}  // namespace thimble
