// Force bounds that keep a handle with some damping of its own passive, for any wanted force and any delay. Over the
// next sample the worst case is F Dx + b_d Dx^2 / h >= -F^2 h / (4 b_d). Hence, with c = 2 b_d / h:
//
//     memoryless          |F_k| <= |F_{k-1} + c Dx_k|              stores F^2 / 2c; contains Colgate's K <= 2 b_d / h
//     least conservative  E_k = E_{k-1} + F_{k-1} Dx_k + b_d Dx_k^2 / h,   |F_k| <= sqrt(4 b_d E_k / h)
//
// Both keep  sum F Dx + b_d sum Dx^2 / h >= 0  for ever (energy bounding: Kim and Ryu 2010). The completed square:
//
//     F Dx + b_d Dx^2 / h = (F + c Dx)^2 / 2c - F^2 / 2c
//
// If the store covers F^2 / 2c, then E_{k+1} >= (F_k + c Dx)^2 / 2c >= 0; the memoryless bound keeps that much for F_{k+1}.
// The price is softness. Without device damping there is no force. If a sample is later than h, the force of the excess
// time may break the bound. The least conservative form then gives no force until the store has recovered.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/control/port_compensator.hpp"

namespace thimble {

class MemorylessBound final : public PortCompensator {
  public:
    using PortCompensator::PortCompensator;
    double reach_N() const { return reach_N_; }  // the most that |F| may be now

  private:
    void clear() override { reach_N_ = 0; }
    void take(double travel_hand_m, double period_s, double force_N) override {
        const double h_s = settings().sample_period_s;
        const double c = 2 * settings().device_damping_Ns_per_m / h_s;
        if (period_s == h_s) {
            reach_N_ = std::fabs(force_N + c * travel_hand_m);
            return;
        }
        // Keeps the stored energy while the damping term changes to that of a longer period.
        const double squared = force_N * force_N + 2 * c * force_N * travel_hand_m +
                               c * c * travel_hand_m * travel_hand_m * h_s / period_s;
        reach_N_ = std::sqrt(std::max(0.0, squared));
    }

    void lose() override { reach_N_ = 0; }
    double answer(double wanted_N) const override { return std::clamp(wanted_N, -reach_N_, reach_N_); }

    double reach_N_ = 0;
};

// The energy that the hand has put in, device damping included, and the force that it allows. Also the store of the two-layer tank.
class EnergyStore {
  public:
    explicit EnergyStore(const PortSettings& settings) : settings_(settings) {}
    void clear() { energy_J_ = 0; }
    void take(double travel_hand_m, double period_s, double force_N) {
        energy_J_ += force_N * travel_hand_m +
                     settings_.device_damping_Ns_per_m * travel_hand_m * travel_hand_m / period_s;
    }
    // A missing sample empties the store: the worst case that the bound allows.
    void lose() { energy_J_ = energy_J_ < 0 ? energy_J_ : 0; }
    double energy_J() const { return energy_J_; }
    double bounded_N(double wanted_N) const {
        const double most_N = std::sqrt(4 * settings_.device_damping_Ns_per_m * std::max(0.0, energy_J_) /
                                        settings_.sample_period_s);
        return std::clamp(wanted_N, -most_N, most_N);
    }

  private:
    PortSettings settings_;
    double energy_J_ = 0;
};

class LeastConservativeBound final : public PortCompensator {
  public:
    explicit LeastConservativeBound(const PortSettings& settings)
        : PortCompensator(settings), store_(settings) {}
    double energy_J() const { return store_.energy_J(); }  // E_k

  private:
    void clear() override { store_.clear(); }
    void take(double travel_hand_m, double period_s, double force_N) override {
        store_.take(travel_hand_m, period_s, force_N);
    }
    void lose() override { store_.lose(); }
    double answer(double wanted_N) const override { return store_.bounded_N(wanted_N); }

    EnergyStore store_;
};

// Two layers: transparency above, passivity below. The store gives no more energy than it has, and a damper fills it
// while it is low (Franken, Stramigioli, Misra, Secchi and Macchelli 2011).
//     E_k   as in energy_bound.hpp
//     F_TLC = d_c (H - E_k) / H v_k   for E_k < H, else 0
//     F_k   = F_wanted + F_TLC, within +-sqrt(4 b_d E_k / h)
// Passive as the least conservative bound is: E_k >= 0.
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
