#include "common/control/port_compensator.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

void PortCompensator::reset() {
    placed_ = blind_ = false;
    refused_ = 0;
    clear();
}

void PortCompensator::observe(double elapsed_s, double position_hand_m, double force_held_N) {
    const bool timely = !placed_ || (std::isfinite(elapsed_s) && elapsed_s > 0);
    if (!timely || !std::isfinite(position_hand_m) || !std::isfinite(force_held_N)) {
        ++refused_;
        blind_ = true;
        lose();
        return;
    }
    // After a gap the force along the way is unknown, so that way is not accounted for.
    if (placed_ && !blind_)
        take(position_hand_m - position_hand_m_, std::max(elapsed_s, settings_.sample_period_s),
             force_held_N);
    placed_ = true;
    blind_ = false;
    position_hand_m_ = position_hand_m;
}

double PortCompensator::force_N(double wanted_N) {
    if (!std::isfinite(wanted_N)) {
        ++refused_;
        wanted_N = 0;
    }
    return placed_ && !blind_ ? answer(wanted_N) : 0;
}

}  // namespace thimble
