#include "cutaneous_node/fingertip/cable_command.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace thimble {

FingerGeometry::FingerGeometry(double cable_angle_rad) : cosine_(std::cos(cable_angle_rad)) {
    assert(cable_angle_rad > 0 && cosine_ > 0);
}

double FingerGeometry::tension_N(double normal_N) const { return std::max(normal_N, 0.0) / (3 * cosine_); }

double FingerGeometry::normal_N(const CableTensions& tensions_N) const {
    double normal_N = 0;
    for (const double tension_N : tensions_N) normal_N += cosine_ * tension_N;
    return normal_N;
}

double ForceShape::shaped_N(double force_N) const {
    // Written so that a NaN is no force.
    return force_N >= deadband_N ? std::min(force_N, limit_N) : 0.0;
}

std::int16_t CableDrive::torque_per_mille(double tension_N, double rated_torque_Nm) const {
    const double torque_Nm = std::max(tension_N, 0.0) * pulley_radius_m / (gear_ratio * efficiency);
    const double per_mille = std::min(std::round(1000 * torque_Nm / rated_torque_Nm), 1000.0);
    return static_cast<std::int16_t>(reversed ? -per_mille : per_mille);
}

double CableDrive::tension_N(std::int16_t torque_per_mille, double rated_torque_Nm) const {
    const double torque_Nm = 1e-3 * (reversed ? -torque_per_mille : torque_per_mille) * rated_torque_Nm;
    return std::max(torque_Nm * gear_ratio * efficiency / pulley_radius_m, 0.0);
}

double CableDrive::wound_m(std::int32_t counts, std::int32_t origin) const {
    const double turns = (static_cast<double>(counts) - origin) / counts_per_turn / gear_ratio;
    return (reversed ? -turns : turns) * 2 * std::numbers::pi * pulley_radius_m;
}

std::int32_t CableDrive::counts(double wound_m, std::int32_t origin) const {
    const double turns = wound_m / (2 * std::numbers::pi * pulley_radius_m);
    const double counts = std::round((reversed ? -turns : turns) * gear_ratio * counts_per_turn);
    return static_cast<std::int32_t>(std::clamp(origin + counts, -2147483648.0, 2147483647.0));
}

bool SlackDetector::slack(double wound_m, double explained_m, double step_s) {
    for_s_ = wound_m - explained_m > margin_m_ ? for_s_ + step_s : 0;
    return for_s_ >= limit_s_;
}

}  // namespace thimble
