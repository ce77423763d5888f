// The load of an emulated drive: motor and gear, one of the three cables of a fingertip device, and a third of the
// pad. In coordinates of the cable (drawn in: positive):
//   m dv/dt = T_motor - T_cable - c v,   3 T_cable cos a = F_pad(x cos a),   x beyond the loose part
// and a first-order lag from the torque asked to the torque made. What the gear loses is in the efficiency of `cable`, both ways alike:
// the torque that a drive shows is its motor's. All numbers are assumptions about motors of 6 mm.
#pragma once

#include <algorithm>

#include "common/math/portable.hpp"
#include "cutaneous_node/fingertip/cable_command.hpp"
#include "cutaneous_node/fingertip/pad_model.hpp"

namespace thimble {

// Far below the fastest of its time constants, 2 ms.
inline constexpr double kPlantStep_s = 0.0005;

struct PlantParameters {
    double mass_kg = 0.08;  // rotor and gear, felt at the cable
    double damping_N_s_per_m = 6;
    double torque_lag_s = 0.002;
    double fastest_m_per_s = 0.1;  // without load
    double loose_m = 0.002;        // before the cable is taut
    double cable_angle_rad = 0.35;
    double position_stiffness_N_per_m = 2000;
    double rated_torque_Nm = 150e-6;
    CableDrive cable;
    PadParameters pad;
};

class CablePlant {
  public:
    explicit CablePlant(const PlantParameters& parameters)
        : parameters_(parameters),
          geometry_(parameters.cable_angle_rad),
          pad_(parameters.pad),
          motor_share_(-portable::expm1(-kPlantStep_s / parameters.torque_lag_s)) {}

    // The command to the power stage.
    void off() { asked_ = Asked::kOff; }
    void ask_torque(std::int16_t per_mille) {
        asked_ = Asked::kTorque;
        asked_N_ = parameters_.cable.tension_N(per_mille, parameters_.rated_torque_Nm);
    }

    void ask_position(std::int32_t counts) {
        asked_ = Asked::kPosition;
        asked_m_ = parameters_.cable.wound_m(counts, 0);
    }

    void advance(double seconds) {
        for (rest_s_ += seconds; rest_s_ >= kPlantStep_s; rest_s_ -= kPlantStep_s) step();
    }

    void cut() { cut_ = true; }

    double tension_N() const { return tension_N_; }
    // of the whole pad, if all three cables pull like this one
    double force_N() const {
        return static_cast<double>(kCablesPerFinger) * geometry_.normal_per_tension() * tension_N_;
    }

    std::int32_t counts() const { return parameters_.cable.counts(wound_m_, 0); }
    std::int16_t torque_per_mille() const {
        return parameters_.cable.torque_per_mille(motor_N_, parameters_.rated_torque_Nm);
    }

  private:
    enum class Asked { kOff, kTorque, kPosition };
    void step() {
        const PlantParameters& p = parameters_;
        if (asked_ == Asked::kPosition) {
            const double limit_N = p.cable.tension_N(p.cable.reversed ? -1000 : 1000, p.rated_torque_Nm);
            asked_N_ = std::clamp(p.position_stiffness_N_per_m * (asked_m_ - wound_m_), 0.0, limit_N);
        }
        const double goal_N = asked_ == Asked::kOff ? 0 : asked_N_;
        motor_N_ += (goal_N - motor_N_) * motor_share_;
        const double push_m_per_s = kPlantStep_s / p.mass_kg * (motor_N_ - tension_N_);
        speed_m_per_s_ =
            (speed_m_per_s_ + push_m_per_s) / (1 + kPlantStep_s * p.damping_N_s_per_m / p.mass_kg);
        speed_m_per_s_ = std::clamp(speed_m_per_s_, -p.fastest_m_per_s, p.fastest_m_per_s);
        wound_m_ += kPlantStep_s * speed_m_per_s_;
        const double taut_m = cut_ ? 0 : std::max(wound_m_ - p.loose_m, 0.0);
        const double force_N = pad_.advance(geometry_.indentation_m(taut_m), kPlantStep_s);
        tension_N_ = force_N / (static_cast<double>(kCablesPerFinger) * geometry_.normal_per_tension());
    }

    PlantParameters parameters_;
    FingerGeometry geometry_;
    PadModel pad_;
    double motor_share_;  // of the way to its goal, in a step
    Asked asked_ = Asked::kOff;
    double asked_N_ = 0, asked_m_ = 0;
    double motor_N_ = 0, wound_m_ = 0, speed_m_per_s_ = 0, tension_N_ = 0;
    double rest_s_ = 0;
    bool cut_ = false;
};

}  // namespace thimble
