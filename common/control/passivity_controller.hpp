// Time-domain passivity observer and controller at one port (Hannaford and Ryu 2002):
//     E_k = E_{k-1} + F_{k-1} Dx_k
//     E_k < 0 and v_k != 0:   a = min(-E_k / (v_k^2 h), a_max),   F_k = F_wanted + a v_k
// The controller sees an outflow only afterwards and takes no more than a_max allows. So E falls below zero by up to
// a tick's outflow and the part beyond a_max. It is a compensator, not a proof (docs/compensators.md has numbers).
// a_max < 2 m / h, with m the mass that moves with the handle. Above that the held damper chatters on its own:
//     z^2 + (c - 1) z + c, with c = a h / 2m, needs c < 1.
// A value of m / h is recommended.
#pragma once

#include <algorithm>

#include "common/control/port_compensator.hpp"

namespace thimble {

class PassivityController final : public PortCompensator {
  public:
    // most_damping_Ns_per_m: a_max, >= 0.
    PassivityController(const PortSettings& settings, double most_damping_Ns_per_m)
        : PortCompensator(settings), most_damping_Ns_per_m_(most_damping_Ns_per_m) {}

    double energy_J() const { return energy_J_; }  // E_k

  private:
    void clear() override { energy_J_ = velocity_m_per_s_ = period_s_ = 0; }
    void take(double travel_hand_m, double period_s, double force_N) override {
        energy_J_ += force_N * travel_hand_m;
        velocity_m_per_s_ = travel_hand_m / period_s;
        period_s_ = period_s;
    }
    void lose() override { velocity_m_per_s_ = 0; }
    double answer(double wanted_N) const override {
        if (energy_J_ >= 0 || velocity_m_per_s_ == 0) return wanted_N;
        const double needed_Ns_per_m = -energy_J_ / (velocity_m_per_s_ * velocity_m_per_s_ * period_s_);
        return wanted_N + std::min(needed_Ns_per_m, most_damping_Ns_per_m_) * velocity_m_per_s_;
    }

    double most_damping_Ns_per_m_;
    double energy_J_ = 0, velocity_m_per_s_ = 0, period_s_ = 0;
};

}  // namespace thimble
