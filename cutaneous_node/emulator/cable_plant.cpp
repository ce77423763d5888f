#include "cutaneous_node/emulator/cable_plant.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

// Far below the fastest of its time constants, 2 ms.
constexpr double kPlantStep_s = 0.0005;

}  // namespace

CablePlant::CablePlant(const PlantParameters& parameters)
    : parameters_(parameters), geometry_(parameters.cable_angle_rad), pad_(parameters.pad) {}

void CablePlant::ask_torque(std::int16_t per_mille) {
    asked_ = Asked::kTorque;
    asked_N_ = parameters_.cable.tension_N(per_mille, parameters_.rated_torque_Nm);
}

void CablePlant::ask_position(std::int32_t counts) {
    asked_ = Asked::kPosition;
    asked_m_ = parameters_.cable.wound_m(counts, 0);
}

void CablePlant::advance(double seconds) {
    for (rest_s_ += seconds; rest_s_ >= kPlantStep_s; rest_s_ -= kPlantStep_s) step(kPlantStep_s);
}

void CablePlant::step(double seconds) {
    const PlantParameters& p = parameters_;
    if (asked_ == Asked::kPosition) {
        const double limit_N = p.cable.tension_N(p.cable.reversed ? -1000 : 1000, p.rated_torque_Nm);
        asked_N_ = std::clamp(p.position_stiffness_N_per_m * (asked_m_ - wound_m_), 0.0, limit_N);
    }
    const double goal_N = asked_ == Asked::kOff ? 0 : asked_N_;
    motor_N_ += (goal_N - motor_N_) * -std::expm1(-seconds / p.torque_lag_s);
    const double push_m_per_s = seconds / p.mass_kg * (motor_N_ - tension_N_);
    speed_m_per_s_ = (speed_m_per_s_ + push_m_per_s) / (1 + seconds * p.damping_N_s_per_m / p.mass_kg);
    speed_m_per_s_ = std::clamp(speed_m_per_s_, -p.fastest_m_per_s, p.fastest_m_per_s);
    wound_m_ += seconds * speed_m_per_s_;
    const double taut_m = cut_ ? 0 : std::max(wound_m_ - p.loose_m, 0.0);
    const double force_N = pad_.advance(geometry_.indentation_m(taut_m), seconds);
    tension_N_ = force_N / (static_cast<double>(kCablesPerFinger) * geometry_.normal_per_tension());
}

double CablePlant::force_N() const {
    return static_cast<double>(kCablesPerFinger) * geometry_.normal_per_tension() * tension_N_;
}

std::int32_t CablePlant::counts() const { return parameters_.cable.counts(wound_m_, 0); }

std::int16_t CablePlant::torque_per_mille() const {
    return parameters_.cable.torque_per_mille(motor_N_, parameters_.rated_torque_Nm);
}

}  // namespace thimble
