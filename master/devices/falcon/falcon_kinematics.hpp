// Geometry of the Novint Falcon, a delta robot: three legs of a thigh (a) and a parallelogram (b), their planes at phi. Closed form
// for leg angles (Stamper 1997), Newton with its derivative for the position, both in metres and radians in the device's own frame:
// z away from the base, the middle of the workspace at z = 0.125 m.
//
// Of each leg, with u, v, w the position in the leg's frame and L = d + e + sqrt(b^2 - (v + f)^2):
//     (u + c - a cos theta)^2 + (w - a sin theta)^2 = L^2
#pragma once

#include <array>
#include <optional>

#include "master/devices/axis_constraint.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

using FalconAngles = std::array<double, 3>;  // theta of each leg, rad

double falcon_leg_angle_rad(std::int16_t encoder_counts);

// Nothing where a leg does not reach.
std::optional<FalconAngles> falcon_leg_angles_rad(const DeviceVector& position_m);

// From a position nearby; nothing if no position has these angles.
std::optional<DeviceVector> falcon_position_m(const FalconAngles& angles_rad,
                                              const DeviceVector& near_m = {0, 0, 0.11});

// tau = (dp/dtheta)^T F at this position; nothing where a leg does not reach or the legs are in line (singular).
std::optional<std::array<double, 3>> falcon_leg_torques_Nm(const DeviceVector& position_m,
                                                           const DeviceVector& force_N);

struct FalconMotors {
    FalconTriple counts{};
    bool saturated = false;  // all three were scaled down together, which keeps the direction
};

// -gain x torque, within +-kFalconMotorLimit. Torques that are not numbers give zero.
FalconMotors falcon_motors(const std::array<double, 3>& torques_Nm, double gain_per_Nm);

}  // namespace thimble
