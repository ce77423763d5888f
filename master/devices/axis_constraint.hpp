// One degree of freedom of a handle that has three: which of the device's axes is the needle's, and what holds the other two.
// Metres and newtons in the device's own frame; along the needle z counts positive into the tissue.
//
// Mechanical clamps hold them in the paper, and need no motor. A virtual constraint is a spring and a damper in each lateral
// direction towards the line through where the handle was when force was enabled,
//     F = -K (p - p_line) - B v,    |F| <= lateral_force_limit_N.
// Sampled each h it stays passive as long as K h / 2 + B <= b, b the damping of device and hand (Colgate and Schenkel 1997):
// K <= 2 (b - B) / h, so at 1 kHz each Ns/m of b bears 2000 N/m, less 2000 N/m for each Ns/m of B.
#pragma once

#include <array>
#include <cstdint>

#include "common/time.hpp"

namespace thimble {

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
    void move_to(SessionTime now, const DeviceVector& position_device_m);
    // The line passes through the newest position.
    void hold_here();

    double position_hand_m() const { return along(position_m_) - settings_.sign * settings_.origin_m; }
    // Of any vector of the device: its part along z.
    double along(const DeviceVector& vector) const { return settings_.sign * vector[settings_.axis]; }
    // Within +-force_limit_N; zero if it is not a number.
    double clipped_N(double force_hand_N) const;
    // The device's force vector that pushes the handle out with force_hand_N, lateral forces included.
    DeviceVector force_device_N(double force_hand_N) const;

  private:
    AxisSettings settings_;
    double force_limit_N_;
    DeviceVector position_m_{}, velocity_m_per_s_{}, line_m_{};
    SessionTime moved_{};
    bool placed_ = false;
};

}  // namespace thimble
