// Time-domain passivity of a network with two ends, energies split by direction (Ryu, Artigas and Preusche 2010;
// Artigas et al. 2011). Each end counts energy that flows in and out there. It reports the inflow to the other end,
// which may give out no more than that. Reported values only grow, so the newest replaces lost and late ones.
//
//     master  dE = F_{k-1} Dx_k without the controller's part: in if > 0, else out.   O = E_in^S(heard) - E_out^M + E_PC^M;
//             O < 0: F_k = F + a v_k,  a = min(-O / (v_k^2 h), a_max),  E_PC^M += a v_k Dx_{k+1}, what it really took
//     slave   dE = F_{k-1} Dx_k: out if > 0, else in.         O = E_in^M(heard) - E_out^S + E_PC^S;   O < 0: the proxy goes back
//             by beta F h = -O / F_{k-1},  E_PC^S -= O
//
// For comparison only. The slave's controller moves the proxy and nothing moves it back. It drifts out of a forbidden
// region while the hand is inside, and the force is gone (docs/compensators.md). F positive pushes the hand out. SI
// units, frame: hand. A reading that is not a number is no sample at the master. Such messages are refused before
// they reach the slave (common/codec.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/control/port_compensator.hpp"

namespace thimble {

class TwoPortMaster {
  public:
    TwoPortMaster(const PortSettings& settings, double most_damping_Ns_per_m)
        : period_s_(settings.sample_period_s), most_damping_Ns_per_m_(most_damping_Ns_per_m) {}

    // x_k and the force that was held on the way. To be sent with x_k: energy_in_J().
    void observe(double position_hand_m, double force_held_N) {
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

    double energy_in_J() const { return energy_in_J_; }
    // Force and E_in^S as they came last. Asked again within a sample it is the last answer that counts.
    double force_N(double wanted_N, double energy_in_slave_J) {
        heard_J_ = std::max(heard_J_, energy_in_slave_J);
        control_N_ = 0;
        const double observed_J = heard_J_ - energy_out_J_ + controlled_J_;
        if (observed_J >= 0 || velocity_m_per_s_ == 0) return wanted_N;
        const double per_damping_J = velocity_m_per_s_ * velocity_m_per_s_ * period_s_;
        const double damping_Ns_per_m = std::min(-observed_J / per_damping_J, most_damping_Ns_per_m_);
        control_N_ = damping_Ns_per_m * velocity_m_per_s_;
        return wanted_N + control_N_;
    }

    void reset() { *this = TwoPortMaster({period_s_, 0}, most_damping_Ns_per_m_); }

  private:
    double period_s_, most_damping_Ns_per_m_;
    bool placed_ = false;
    double position_hand_m_ = 0, velocity_m_per_s_ = 0;
    double energy_in_J_ = 0, energy_out_J_ = 0, controlled_J_ = 0, heard_J_ = 0;
    double control_N_ = 0;  // a v, held in this sample: no part of what the network does
};

// The slave end: a proxy of the needle, whatever tissue or fixture pushes on it.
class TwoPortSlave {
  public:
    // In one sample the proxy goes back by at most this: what is owed beyond it stays owed.
    explicit TwoPortSlave(double most_correction_m = std::numeric_limits<double>::infinity())
        : most_correction_m_(most_correction_m) {}

    // Position and E_in^M as they came last, and the force that was held on the way. Where the proxy is then.
    double move(double position_hand_m, double force_held_N, double energy_in_master_J) {
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
            const double back_m =
                std::clamp(observed_J / force_held_N, -most_correction_m_, most_correction_m_);
            position_proxy_m_ += back_m;
            controlled_J_ -= force_held_N * back_m;
        }
        return position_proxy_m_;
    }

    double energy_in_J() const { return energy_in_J_; }
    double position_proxy_m() const { return position_proxy_m_; }
    void reset() { *this = TwoPortSlave(most_correction_m_); }

  private:
    double most_correction_m_;
    bool placed_ = false;
    double position_hand_m_ = 0, position_proxy_m_ = 0;
    double energy_in_J_ = 0, energy_out_J_ = 0, controlled_J_ = 0, heard_J_ = 0;
};

// Before a wall that is a spring.
class TwoPortWall {
  public:
    TwoPortWall(double wall_m, double stiffness_N_per_m, double force_limit_N)
        : wall_m_(wall_m), stiffness_N_per_m_(stiffness_N_per_m), force_limit_N_(force_limit_N) {}

    // Position and E_in^M as they came last; the force to send back, with energy_in_J().
    double force_N(double position_hand_m, double energy_in_master_J) {
        slave_.move(position_hand_m, spring_N(), energy_in_master_J);
        return spring_N();
    }

    double energy_in_J() const { return slave_.energy_in_J(); }
    double position_proxy_m() const { return slave_.position_proxy_m(); }

  private:
    double spring_N() const {
        return std::clamp(stiffness_N_per_m_ * (slave_.position_proxy_m() - wall_m_), 0.0, force_limit_N_);
    }

    double wall_m_, stiffness_N_per_m_, force_limit_N_;
    TwoPortSlave slave_;
};

}  // namespace thimble
