// One degree of freedom of a handle that has three: which of the device's axes is the needle's, and what holds the other two.
// Metres and newtons in the device's own frame; along the needle z counts positive into the tissue.
//
// Mechanical clamps hold them in the paper, and need no motor. A virtual constraint is a spring and a damper in each lateral
// direction towards the line through where the handle was when force was enabled,
//     F = -K (p - p_line) - B v,    |F| <= lateral_force_limit_N.
// Sampled each h it stays passive as long as K h / 2 + B <= b, b the damping of device and hand (Colgate and Schenkel 1997):
// K <= 2 (b - B) / h, so at 1 kHz each Ns/m of b bears 2000 N/m, less 2000 N/m for each Ns/m of B.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/time.hpp"

namespace thimble {

inline constexpr double kVelocityLag_s = 0.005;

// After a longer gap between two samples the velocity is unknown.
inline constexpr double kForgotten_s = 0.05;

using DeviceVector = std::array<double, 3>;  // x, y, z of the device

enum class LateralHold : std::uint8_t { kClamps, kVirtual };

struct AxisSettings {
    std::size_t axis = 0;  // of the device: 0 x, 1 y, 2 z
    double sign = 1;       // +1: the device's axis points into the tissue, -1: out of it
    double origin_m = 0;   // along the device's axis: where the hand's z is 0
    LateralHold lateral = LateralHold::kClamps;
    double lateral_stiffness_N_per_m = 1000;
    double lateral_damping_Ns_per_m = 1;
    double lateral_force_limit_N = 4;
};

class AxisConstraint {
  public:
    AxisConstraint(const AxisSettings& settings, double force_limit_N)
        : settings_(settings), force_limit_N_(force_limit_N) {}

    // A measured position; velocities follow it with a time constant of 5 ms.
    void move_to(SessionTime now, const DeviceVector& position_device_m) {
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

    // The line passes through the newest position.
    void hold_here() { line_m_ = position_m_; }

    double position_hand_m() const { return along(position_m_) - settings_.sign * settings_.origin_m; }
    // The component of a device vector along z.
    double along(const DeviceVector& vector) const { return settings_.sign * vector[settings_.axis]; }
    // Within +-force_limit_N; zero if it is not a number.
    double clipped_N(double force_hand_N) const {
        if (!std::isfinite(force_hand_N)) return 0;
        return std::clamp(force_hand_N, -force_limit_N_, force_limit_N_);
    }

    // The device's force vector that pushes the handle out with force_hand_N, lateral forces included.
    DeviceVector force_device_N(double force_hand_N) const {
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

  private:
    AxisSettings settings_;
    double force_limit_N_;
    DeviceVector position_m_{}, velocity_m_per_s_{}, line_m_{};
    SessionTime moved_{};
    bool placed_ = false;
};

}  // namespace thimble
