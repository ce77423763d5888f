#include "common/control/passivity_controller.hpp"

#include <algorithm>

namespace thimble {

void PassivityController::take(double travel_hand_m, double period_s, double force_N) {
    energy_J_ += force_N * travel_hand_m;
    velocity_m_per_s_ = travel_hand_m / period_s;
    period_s_ = period_s;
}

double PassivityController::answer(double wanted_N) const {
    if (energy_J_ >= 0 || velocity_m_per_s_ == 0) return wanted_N;
    const double needed_Ns_per_m = -energy_J_ / (velocity_m_per_s_ * velocity_m_per_s_ * period_s_);
    return wanted_N + std::min(needed_Ns_per_m, most_damping_Ns_per_m_) * velocity_m_per_s_;
}

}  // namespace thimble
