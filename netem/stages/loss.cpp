#include "netem/stages/loss.hpp"

#include <array>

namespace thimble {
namespace {

// State after a move by `u` from state 1, 2, 3 or 4.
int next_state(const LossSettings& loss, int state, double u) {
    switch (state) {
        case 1:
            if (u < loss.p13) return 3;
            return u < loss.p13 + loss.p14 ? 4 : 1;
        case 2:
            return u < loss.p23 ? 3 : 2;
        case 3:
            if (u < loss.p31) return 1;
            return u < loss.p31 + loss.p32 ? 2 : 3;
        default:
            return 1;
    }
}

int stationary_state(const LossSettings& loss, double u) {
    const std::array<double, 4> shares = four_state_shares(loss);
    double sum = 0;
    for (int state = 1; state < 4; ++state) {
        sum += shares[static_cast<std::size_t>(state - 1)];
        if (u < sum) return state;
    }
    return shares[3] > 0 ? 4 : 1;  // not a state that rounding alone would reach
}

}  // namespace

void Loss::configure(const LossSettings& settings) {
    if (settings != settings_) begun_ = false;
    settings_ = settings;
}

bool Loss::lost(std::uint64_t packet) {
    switch (settings_.shape) {
        case LossShape::kNone:
            return false;
        case LossShape::kIndependent:
            return lost(packet, settings_.probability);
        case LossShape::kGilbertElliott:
            return lost_by_gilbert_elliott(packet);
        case LossShape::kFourState:
            return lost_by_four_state(packet);
    }
    return false;
}

bool Loss::lost_by_gilbert_elliott(std::uint64_t packet) {
    const double u = moves_.uniform(packet);
    if (!begun_) {
        bad_ = u < share_in_bad(settings_);
    } else {
        bad_ = bad_ ? u >= settings_.bad_to_good : u < settings_.good_to_bad;
    }
    begun_ = true;
    return lost(packet, bad_ ? settings_.loss_in_bad : settings_.loss_in_good);
}

bool Loss::lost_by_four_state(std::uint64_t packet) {
    const double u = moves_.uniform(packet);
    state_ = begun_ ? next_state(settings_, state_, u) : stationary_state(settings_, u);
    begun_ = true;
    return state_ >= 3;
}

}  // namespace thimble
