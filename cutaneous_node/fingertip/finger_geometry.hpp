// A fingertip device: three cables draw a platform against the pad. Each leaves the platform at the angle `cable_angle_rad`
// from the normal of the pad, 120 degrees from the next one around it. Frame of the pad: z into the finger, x to the finger's
// right, y towards its tip; cable 0 lies towards y.
//   F_z = cos a sum T_i,   F_xy = sin a sum T_i (cos p_i, sin p_i),   p_i = 90 deg + i 120 deg
// The device of the experiments presses along z only; x and y are there so that a direction needs no other geometry.
#pragma once

#include <array>
#include <cstddef>

namespace thimble {

inline constexpr std::size_t kCablesPerFinger = 3;
using CableTensions = std::array<double, kCablesPerFinger>;  // N

struct PadForce {
    double normal_N = 0;  // z, >= 0: cables cannot push
    double x_N = 0, y_N = 0;
};

class FingerGeometry {
  public:
    // 0 < cable_angle_rad < pi/2.
    explicit FingerGeometry(double cable_angle_rad);

    // None below 0: a force that would need a pushing cable loses as much of its x and y as is needed, and nothing of z.
    CableTensions tensions_N(const PadForce& force) const;
    PadForce force(const CableTensions& tensions_N) const;
    // Of one cable that is drawn in by so much, the platform's end of it goes into the pad.
    double indentation_m(double wound_m) const { return wound_m * cosine_; }
    double wound_m(double indentation_m) const { return indentation_m / cosine_; }
    double normal_per_tension() const { return cosine_; }

  private:
    double cosine_, sine_;
    CableTensions towards_x_, towards_y_;
};

}  // namespace thimble
