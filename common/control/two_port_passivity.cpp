#include "common/control/two_port_passivity.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

void TwoPortMaster::observe(double position_hand_m, double force_held_N) {
    if (!std::isfinite(position_hand_m) || !std::isfinite(force_held_N)) return;
    const double travel_m = placed_ ? position_hand_m - position_hand_m_ : 0;
    controlled_J_ += control_N_ * travel_m;
    const double flow_J = (force_held_N - control_N_) * travel_m;
    control_N_ = 0;
    (flow_J > 0 ? energy_in_J_ : energy_out_J_) += flow_J > 0 ? flow_J : -flow_J;
    velocity_m_per_s_ = travel_m / period_s_;
    position_hand_m_ = position_hand_m;
    placed_ = true;
}

double TwoPortMaster::force_N(double wanted_N, double energy_in_slave_J) {
    heard_J_ = std::max(heard_J_, energy_in_slave_J);
    control_N_ = 0;
    const double observed_J = heard_J_ - energy_out_J_ + controlled_J_;
    if (observed_J >= 0 || velocity_m_per_s_ == 0) return wanted_N;
    const double per_damping_J = velocity_m_per_s_ * velocity_m_per_s_ * period_s_;
    const double damping_Ns_per_m = std::min(-observed_J / per_damping_J, most_damping_Ns_per_m_);
    control_N_ = damping_Ns_per_m * velocity_m_per_s_;
    return wanted_N + control_N_;
}

void TwoPortMaster::reset() { *this = TwoPortMaster({period_s_, 0}, most_damping_Ns_per_m_); }

double TwoPortSlave::move(double position_hand_m, double force_held_N, double energy_in_master_J) {
    heard_J_ = std::max(heard_J_, energy_in_master_J);
    if (!placed_) position_hand_m_ = position_proxy_m_ = position_hand_m;
    placed_ = true;
    const double travel_m = position_hand_m - position_hand_m_;
    position_hand_m_ = position_hand_m;
    position_proxy_m_ += travel_m;
    // The force that was held on the way, as the master counts.
    const double flow_J = force_held_N * travel_m;
    (flow_J > 0 ? energy_out_J_ : energy_in_J_) += flow_J > 0 ? flow_J : -flow_J;
    const double observed_J = heard_J_ - energy_out_J_ + controlled_J_;
    if (observed_J < 0 && force_held_N != 0) {
        const double back_m = std::clamp(observed_J / force_held_N, -most_correction_m_, most_correction_m_);
        position_proxy_m_ += back_m;
        controlled_J_ -= force_held_N * back_m;
    }
    return position_proxy_m_;
}

void TwoPortSlave::reset() { *this = TwoPortSlave(most_correction_m_); }

double TwoPortWall::spring_N() const {
    return std::clamp(stiffness_N_per_m_ * (slave_.position_proxy_m() - wall_m_), 0.0, force_limit_N_);
}

double TwoPortWall::force_N(double position_hand_m, double energy_in_master_J) {
    slave_.move(position_hand_m, spring_N(), energy_in_master_J);
    return spring_N();
}

}  // namespace thimble
