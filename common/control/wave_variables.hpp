// Wave variables (Niemeyer and Slotine 1991): instead of position and force, u and w travel. A channel that delivers each wave at most once gives out no more energy, sum of u^2 h / 2, than it got, with any delay.
//
//     master   F_k = b v_k - sqrt(2b) w_k,  v_k = Dx_k / h;     at k + 1 it sends u = (b v_{k+1} + F_k) / sqrt(2b)
//     slave    x_free = x + sqrt(2b) u h / b,  x = x_free - F h / b,  w = u - sqrt(2/b) F,  with F implicitly that of a wall K,
//              a damper, and whatever else pushes:  F = K (x - wall)^+ + b_s (x - x_{k-1}) / h + F_other
//
// The slave's end is lossless: F (x_k - x_{k-1}) = h (u^2 - w^2) / 2 whatever F is. The held force of the master leaks a little
// (0.05 mJ at most in the standard approach of docs/compensators.md). Held against the wall with force F at a delay T there and
// back together, the hand is F (T + h) / (2b) further than the slave: the price. b: wave impedance, Ns/m; 10 to 50 suits a
// hand, and b < 2 m / h, or the held damper chatters. F positive pushes the hand out. SI units, frame: hand.
#pragma once

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
void check_wave_settings(const WaveSettings& settings);

class WaveMaster {
  public:
    explicit WaveMaster(const WaveSettings& settings);
    void reset() { *this = WaveMaster(settings_); }

    // Where the hand is, and the force that was held on the way there. Returns the wave to send. A value that is no number counts as no motion and no force.
    double wave_out(double position_hand_m, double force_held_N);
    // The force that the returned wave gives, before any saturation.
    double force_N(double wave_in_root_W) const;

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
    explicit WaveSlave(const WaveSettings& settings);
    // At rest here.
    void place(double position_m) {
        position_m_ = position_m;
        force_N_ = 0;
    }

    // One sample. other_N: any other force on it, as it was at the sample before. Returns the wave to send back.
    double step(double wave_in_root_W, const WaveWall& wall, double other_N, double force_limit_N);

    double position_m() const { return position_m_; }
    double force_N() const { return force_N_; }  // on the hand, wall and others together

  private:
    WaveSettings settings_;
    double root_2b_, root_2_per_b_;
    double position_m_ = 0, force_N_ = 0;
};

}  // namespace thimble
