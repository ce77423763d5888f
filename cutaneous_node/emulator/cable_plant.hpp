// The load of an emulated drive: motor and gear, one of the three cables of a fingertip device, and a third of the pad. In coordinates of the cable (drawn in: positive):
//   m dv/dt = T_motor - T_cable - c v,   3 T_cable cos a = F_pad(x cos a),   x beyond the loose part
// and a first-order lag from the torque asked to the torque made. What the gear loses is in the efficiency of `cable`, both ways alike:
// the torque that a drive shows is its motor's. All numbers are assumptions about motors of 6 mm.
#pragma once

#include "cutaneous_node/fingertip/cable_command.hpp"
#include "cutaneous_node/fingertip/pad_model.hpp"

namespace thimble {

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
    explicit CablePlant(const PlantParameters& parameters);

    // The command to the power stage.
    void off() { asked_ = Asked::kOff; }
    void ask_torque(std::int16_t per_mille);
    void ask_position(std::int32_t counts);
    void advance(double seconds);
    void cut() { cut_ = true; }

    double tension_N() const { return tension_N_; }
    double force_N() const;  // of the whole pad, if all three cables pull like this one
    std::int32_t counts() const;
    std::int16_t torque_per_mille() const;

  private:
    enum class Asked { kOff, kTorque, kPosition };
    void step(double seconds);

    PlantParameters parameters_;
    FingerGeometry geometry_;
    PadModel pad_;
    Asked asked_ = Asked::kOff;
    double asked_N_ = 0, asked_m_ = 0;
    double motor_N_ = 0, wound_m_ = 0, speed_m_per_s_ = 0, tension_N_ = 0;
    double rest_s_ = 0;
    bool cut_ = false;
};

}  // namespace thimble
