#include "visual_node/gamepad/rumble_pace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace thimble {
namespace {

constexpr double kFullLevel = 65535;
// A finger cannot feel a smaller step.
constexpr int kLeastStep = 65536 / 32;

bool far_apart(std::uint16_t a, std::uint16_t b) {
    return std::abs(int{a} - int{b}) >= kLeastStep || (a == 0) != (b == 0);
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

}  // namespace thimble
