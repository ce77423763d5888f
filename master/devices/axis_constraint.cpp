#include "master/devices/axis_constraint.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

constexpr double kVelocityLag_s = 0.005;
// Longer than this between two samples says nothing about the velocity now.
constexpr double kForgotten_s = 0.05;

}  // namespace

void AxisConstraint::move_to(SessionTime now, const DeviceVector& position_device_m) {
    const double elapsed_s = to_seconds(now - moved_);
    if (placed_ && elapsed_s <= 0) return;
    for (std::size_t i = 0; i < 3; ++i) {
        const double slope_m_per_s = placed_ ? (position_device_m[i] - position_m_[i]) / elapsed_s : 0;
        velocity_m_per_s_[i] +=
            elapsed_s / (kVelocityLag_s + elapsed_s) * (slope_m_per_s - velocity_m_per_s_[i]);
        if (!placed_ || elapsed_s > kForgotten_s) velocity_m_per_s_[i] = 0;
    }
    position_m_ = position_device_m;
    moved_ = now;
    placed_ = true;
}

void AxisConstraint::hold_here() { line_m_ = position_m_; }

double AxisConstraint::clipped_N(double force_hand_N) const {
    if (!std::isfinite(force_hand_N)) return 0;
    return std::clamp(force_hand_N, -force_limit_N_, force_limit_N_);
}

DeviceVector AxisConstraint::force_device_N(double force_hand_N) const {
    DeviceVector force_N{};
    if (settings_.lateral == LateralHold::kVirtual) {
        double squared = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            if (i == settings_.axis) continue;
            force_N[i] = -settings_.lateral_stiffness_N_per_m * (position_m_[i] - line_m_[i]) -
                         settings_.lateral_damping_Ns_per_m * velocity_m_per_s_[i];
            squared += force_N[i] * force_N[i];
        }
        const double length_N = std::sqrt(squared);
        if (length_N > settings_.lateral_force_limit_N) {
            for (double& component_N : force_N) component_N *= settings_.lateral_force_limit_N / length_N;
        }
    }
    force_N[settings_.axis] = -settings_.sign * clipped_N(force_hand_N);
    return force_N;
}

}  // namespace thimble
