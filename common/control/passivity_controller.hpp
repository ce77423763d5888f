// Time-domain passivity observer and controller at one port (Hannaford and Ryu 2002):
//     E_k = E_{k-1} + F_{k-1} Dx_k
//     E_k < 0 and v_k != 0:   a = min(-E_k / (v_k^2 h), a_max),   F_k = F_wanted + a v_k
// The controller sees an outflow only once it has happened and takes no more than a_max allows: E falls below zero by up
// to a tick's outflow and whatever a_max cannot take. It is a compensator, not a proof (docs/compensators.md has numbers).
// a_max < 2 m / h, m the mass that moves with the handle: above, the held damper chatters by itself
// (z^2 + (c - 1) z + c with c = a h / 2m needs c < 1); m / h is recommended.
#pragma once

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
    void take(double travel_hand_m, double period_s, double force_N) override;
    void lose() override { velocity_m_per_s_ = 0; }
    double answer(double wanted_N) const override;

    double most_damping_Ns_per_m_;
    double energy_J_ = 0, velocity_m_per_s_ = 0, period_s_ = 0;
};

}  // namespace thimble
