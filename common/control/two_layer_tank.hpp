// Transparency above, passivity below: a store that gives no more than it has, and a damper that fills it while it is low
// (in the manner of Franken, Stramigioli, Misra, Secchi and Macchelli 2011).
//     E_k   as in energy_bound.hpp
//     F_TLC = d_c (H - E_k) / H v_k   for E_k < H, else 0
//     F_k   = F_wanted + F_TLC, within +-sqrt(4 b_d E_k / h)
// Passive as the least conservative bound is: E_k >= 0.
#pragma once

#include "common/control/energy_bound.hpp"

namespace thimble {

struct TankSettings {
    double level_J = 0.05;         // H, > 0
    double damping_Ns_per_m = 10;  // d_c, >= 0: how strongly free motion pays for it
};

class TwoLayerTank final : public PortCompensator {
  public:
    TwoLayerTank(const PortSettings& settings, const TankSettings& tank)
        : PortCompensator(settings), tank_(tank), store_(settings) {}
    double energy_J() const { return store_.energy_J(); }  // E_k

  private:
    void clear() override {
        store_.clear();
        velocity_m_per_s_ = 0;
    }
    void take(double travel_hand_m, double period_s, double force_N) override {
        store_.take(travel_hand_m, period_s, force_N);
        velocity_m_per_s_ = travel_hand_m / period_s;
    }
    void lose() override {
        store_.lose();
        velocity_m_per_s_ = 0;
    }
    double answer(double wanted_N) const override {
        const double missing_J = tank_.level_J - store_.energy_J();
        const double charge_N =
            missing_J > 0 ? tank_.damping_Ns_per_m * missing_J / tank_.level_J * velocity_m_per_s_ : 0;
        return store_.bounded_N(wanted_N + charge_N);
    }

    TankSettings tank_;
    EnergyStore store_;
    double velocity_m_per_s_ = 0;
};

}  // namespace thimble
