#include "visual_node/gamepad/rumble.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

#include <climits>
#include <fmt/format.h>

namespace thimble {
namespace {

bool rumbles(int file) {
    constexpr std::size_t kBits = sizeof(unsigned long) * CHAR_BIT;
    std::array<unsigned long, FF_CNT / kBits + 1> effects{};
    if (::ioctl(file, EVIOCGBIT(EV_FF, sizeof effects), effects.data()) < 0) return false;
    return (effects.at(FF_RUMBLE / kBits) >> (FF_RUMBLE % kBits) & 1UL) != 0;
}

}  // namespace

RumbleDevice::RumbleDevice(const std::filesystem::path& event)
    : file_(::open(event.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK)), event_(event.string()) {
    if (file_ < 0 && errno == EACCES) {
        fail("may not be written: add the user to the group that owns it, often 'input'");
    } else if (file_ < 0) {
        fail(std::strerror(errno));
    } else if (!rumbles(file_)) {
        fail("has no motors (FF_RUMBLE)");
    }
}

void RumbleDevice::set(const RumbleLevels& levels) {
    if (!ready()) return;
    const bool off = levels == RumbleLevels{};
    if (off && effect_ < 0) return;  // nothing was ever played
    const bool done = off ? play(0) : upload(levels) && play(1);
    if (!done && errno != EINTR) fail(errno == ENODEV ? "is gone" : std::strerror(errno));
}

bool RumbleDevice::upload(const RumbleLevels& levels) {
    ff_effect effect{};
    effect.type = FF_RUMBLE;
    effect.id = effect_;
    effect.u.rumble.strong_magnitude = levels.strong;
    effect.u.rumble.weak_magnitude = levels.weak;
    effect.replay.length = static_cast<std::uint16_t>(to_seconds(kRumbleLasts) * 1e3);  // ms
    if (::ioctl(file_, EVIOCSFF, &effect) < 0) return false;
    effect_ = effect.id;
    return true;
}

bool RumbleDevice::play(int times) {
    input_event event{};
    event.type = EV_FF;
    event.code = static_cast<std::uint16_t>(effect_);
    event.value = times;
    return ::write(file_, &event, sizeof event) == static_cast<ssize_t>(sizeof event);
}

void RumbleDevice::fail(const std::string& what) {
    notice_ = fmt::format("the gamepad does not vibrate: {} {}", event_, what);
    if (file_ >= 0) ::close(std::exchange(file_, -1));
    effect_ = -1;
}

// Closing takes the effect away, too: the kernel stops what is played by a file that is closed.
RumbleDevice::~RumbleDevice() {
    if (file_ < 0) return;
    if (effect_ >= 0) play(0);
    ::close(file_);
}

}  // namespace thimble
