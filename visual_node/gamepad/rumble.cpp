#include "visual_node/gamepad/rumble.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
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

constexpr double kFullLevel = 65535;
// A smaller step is none that a finger tells from the last.
constexpr int kLeastStep = 65536 / 32;

bool far_apart(std::uint16_t a, std::uint16_t b) {
    return std::abs(int{a} - int{b}) >= kLeastStep || (a == 0) != (b == 0);
}

bool rumbles(int file) {
    constexpr std::size_t kBits = sizeof(unsigned long) * CHAR_BIT;
    std::array<unsigned long, FF_CNT / kBits + 1> effects{};
    if (::ioctl(file, EVIOCGBIT(EV_FF, sizeof effects), effects.data()) < 0) return false;
    return (effects.at(FF_RUMBLE / kBits) >> (FF_RUMBLE % kBits) & 1UL) != 0;
}

}  // namespace

// Written so that a NaN stops it.
std::uint16_t RumblePace::Motor::level(double force_N) {
    turns_ = force_N > (turns_ ? kRumbleStops_N : kRumbleStarts_N);
    if (!turns_) return 0;
    const double share = std::min(force_N / kFullRumble_N, 1.0);
    return static_cast<std::uint16_t>(
        std::lround((kWeakestRumble + (1 - kWeakestRumble) * share) * kFullLevel));
}

bool RumblePace::worth_saying(SessionTime now, const RumbleLevels& levels) const {
    if (far_apart(levels.strong, said_.strong) || far_apart(levels.weak, said_.weak)) return true;
    return levels != RumbleLevels{} && now - said_at_ >= kSayAgain;
}

std::optional<RumbleLevels> RumblePace::next(SessionTime now, double index_N, double thumb_N) {
    const RumbleLevels levels{strong_.level(index_N), weak_.level(thumb_N)};
    if (said_anything_ && now - said_at_ < kPeriod) return std::nullopt;
    if (!worth_saying(now, levels)) return std::nullopt;
    said_ = levels;
    said_at_ = now;
    said_anything_ = true;
    return levels;
}

void RumblePace::forget() { *this = RumblePace{}; }

RumbleDevice::RumbleDevice(const std::filesystem::path& event)
    : file_(::open(event.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK)), event_(event.string()) {
    if (file_ < 0 && errno == EACCES) {
        fail("may not be written to: the user must be in the group that owns it, often 'input'");
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
    effect.replay.length = static_cast<std::uint16_t>(to_seconds(kLasts) * 1e3);  // ms
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
