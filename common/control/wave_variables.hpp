// Wave variables (Niemeyer and Slotine 1991): u and w travel instead of position and force. A channel that delivers
// each wave at most once gives out no more energy, sum of u^2 h / 2, than it got, with any delay.
//
//     master   F_k = b v_k - sqrt(2b) w_k,  v_k = Dx_k / h;     at k + 1 it sends u = (b v_{k+1} + F_k) / sqrt(2b)
//     slave    x_free = x + sqrt(2b) u h / b,  x = x_free - F h / b,  w = u - sqrt(2/b) F,  with F implicitly that of a wall K,
//              a damper, and whatever else pushes:  F = K (x - wall)^+ + b_s (x - x_{k-1}) / h + F_other
//
// The slave's end is lossless: F (x_k - x_{k-1}) = h (u^2 - w^2) / 2 whatever F is. The held force of the master
// leaks a little (0.05 mJ at most in unit_common's CompensatorsGolden). The price of waves is distance:
// at a wall with force F and a round-trip delay T, the hand stands F (T + h) / (2b) further than the slave.
// The wave impedance b is in Ns/m. A hand needs 10 to 50. From b = 2 m / h on, the held damper chatters.
// A positive F pushes the hand out. SI units, frame: hand.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"

namespace thimble {

struct WaveSettings {
    double impedance_Ns_per_m = 20;  // b
    double sample_period_s = 1e-3;   // h
    // The slave's own damper, solved for like the wall; >= 0. Without, a free slave sends every wave back whole, and what an
    // encoder adds to them grows between the two ends until the hand takes it; with b, none comes back. It is felt as drag.
    double slave_damping_Ns_per_m = 0;
};

// Throws Error (usage) unless the first two are finite and above 0: with an impedance of 0 or infinity no wave carries both
// velocity and force.
inline const WaveSettings& checked(const WaveSettings& settings) {
    const auto good = [](double value) { return std::isfinite(value) && value > 0; };
    if (good(settings.impedance_Ns_per_m) && good(settings.sample_period_s) &&
        settings.slave_damping_Ns_per_m >= 0)
        return settings;
    throw Error(ExitCode::kUsage,
                "wave variables need an impedance and a sample period above 0 and finite, not " +
                    std::to_string(settings.impedance_Ns_per_m) + " Ns/m and " +
                    std::to_string(settings.sample_period_s) + " s");
}

class WaveMaster {
  public:
    explicit WaveMaster(const WaveSettings& settings)
        : settings_(checked(settings)), root_2b_(std::sqrt(2 * settings.impedance_Ns_per_m)) {}
    void reset() { *this = WaveMaster(settings_); }

    // Where the hand is, and the force that was held on the way there. Returns the wave to send. A value that is no
    // number counts as no motion and no force.
    double wave_out(double position_hand_m, double force_held_N) {
        if (!std::isfinite(position_hand_m)) position_hand_m = position_hand_m_;
        if (!std::isfinite(force_held_N)) force_held_N = 0;
        velocity_m_per_s_ = placed_ ? (position_hand_m - position_hand_m_) / settings_.sample_period_s : 0;
        position_hand_m_ = position_hand_m;
        placed_ = true;
        return (settings_.impedance_Ns_per_m * velocity_m_per_s_ + force_held_N) / root_2b_;
    }

    // The force that the returned wave gives, before any saturation.
    double force_N(double wave_in_root_W) const {
        return settings_.impedance_Ns_per_m * velocity_m_per_s_ - root_2b_ * wave_in_root_W;
    }

  private:
    WaveSettings settings_;
    double root_2b_;
    bool placed_ = false;
    double position_hand_m_ = 0, velocity_m_per_s_ = 0;
};

struct WaveWall {
    double position_m = 0;
    double stiffness_N_per_m = 0;  // 0: none; infinity: rigid
};

class WaveSlave {
  public:
    explicit WaveSlave(const WaveSettings& settings)
        : settings_(checked(settings)),
          root_2b_(std::sqrt(2 * settings.impedance_Ns_per_m)),
          root_2_per_b_(std::sqrt(2 / settings.impedance_Ns_per_m)) {}

    // At rest here.
    void place(double position_m) {
        position_m_ = position_m;
        force_N_ = 0;
    }

    // One sample. other_N: any other force on it, as it was at the sample before. Returns the wave to send back.
    double step(double wave_in_root_W, const WaveWall& wall, double other_N, double force_limit_N) {
        const double h_s = settings_.sample_period_s, b_s = settings_.slave_damping_Ns_per_m;
        const double mobility_m_per_N = h_s / settings_.impedance_Ns_per_m;  // h / b
        const double drive_m = root_2b_ * wave_in_root_W * mobility_m_per_N;
        // With the damper: how far it would go without the wall, and how far a newton then moves it.
        const double softer = 1 / (1 + b_s / settings_.impedance_Ns_per_m);
        const double beyond_m =
            position_m_ + softer * (drive_m - other_N * mobility_m_per_N) - wall.position_m;
        const double wall_N =
            beyond_m > 0 ? beyond_m / (softer * mobility_m_per_N + 1 / wall.stiffness_N_per_m) : 0;
        const double travel_m = softer * (drive_m - (other_N + wall_N) * mobility_m_per_N);
        const double force = other_N + wall_N + b_s * travel_m / h_s;
        force_N_ = std::clamp(force, -force_limit_N, force_limit_N);
        position_m_ += drive_m - force_N_ * mobility_m_per_N;
        return wave_in_root_W - root_2_per_b_ * force_N_;
    }

    double position_m() const { return position_m_; }
    double force_N() const { return force_N_; }  // on the hand, wall and others together

  private:
    WaveSettings settings_;
    double root_2b_, root_2_per_b_;
    double position_m_ = 0, force_N_ = 0;
};

}  // namespace thimble
