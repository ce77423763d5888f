// From the force for a finger to the commands of its drives, and back: deadband and limit, pretension, pulley and gear.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "common/math/portable.hpp"

namespace thimble {

inline constexpr std::size_t kCablesPerFinger = 3;
using CableTensions = std::array<double, kCablesPerFinger>;  // N

// A fingertip device: three cables draw a platform against the pad, along its normal. Each leaves the platform at the angle
// `cable_angle_rad` from the normal, 120 degrees from the next one around it.
class FingerGeometry {
  public:
    // 0 < cable_angle_rad < pi/2.
    explicit FingerGeometry(double cable_angle_rad) : cosine_(portable::cos(cable_angle_rad)) {
        assert(cable_angle_rad > 0 && cosine_ > 0);
    }

    // Of each cable; >= 0: cables cannot push.
    double tension_N(double normal_N) const { return std::max(normal_N, 0.0) / (3 * cosine_); }
    double normal_N(const CableTensions& tensions_N) const {
        double normal_N = 0;
        for (const double tension_N : tensions_N) normal_N += cosine_ * tension_N;
        return normal_N;
    }

    // Of one cable that is drawn in by so much, the platform's end of it goes into the pad.
    double indentation_m(double wound_m) const { return wound_m * cosine_; }
    double wound_m(double indentation_m) const { return indentation_m / cosine_; }
    double normal_per_tension() const { return cosine_; }

  private:
    double cosine_;
};

struct ForceShape {
    double deadband_N = 0.02;  // less is no force
    double limit_N = 1.5;

    // NaN: no force
    double shaped_N(double force_N) const {
        // Written so that a NaN is no force.
        return force_N >= deadband_N ? std::min(force_N, limit_N) : 0.0;
    }
};

// One cable's way to its motor. The values are assumptions, of a small geared motor.
struct CableDrive {
    double pulley_radius_m = 0.0025;
    double gear_ratio = 16;       // motor turns per pulley turn
    double efficiency = 0.8;      // of the gear, motor to cable
    double counts_per_turn = 64;  // of the motor
    bool reversed = false;        // a positive torque slackens the cable

    // Per mille of the drive's rated torque (0x6071, 0x6077), 1000 at most.
    std::int16_t torque_per_mille(double tension_N, double rated_torque_Nm) const {
        const double torque_Nm = std::max(tension_N, 0.0) * pulley_radius_m / (gear_ratio * efficiency);
        const double per_mille = std::min(std::round(1000 * torque_Nm / rated_torque_Nm), 1000.0);
        return static_cast<std::int16_t>(reversed ? -per_mille : per_mille);
    }

    // >= 0: a cable that a motor turns out of is slack.
    double tension_N(std::int16_t torque_per_mille, double rated_torque_Nm) const {
        const double torque_Nm = 1e-3 * (reversed ? -torque_per_mille : torque_per_mille) * rated_torque_Nm;
        return std::max(torque_Nm * gear_ratio * efficiency / pulley_radius_m, 0.0);
    }

    // How much of the cable has been drawn in since the count was `origin`.
    double wound_m(std::int32_t counts, std::int32_t origin) const {
        const double turns = (static_cast<double>(counts) - origin) / counts_per_turn / gear_ratio;
        return (reversed ? -turns : turns) * 2 * std::numbers::pi * pulley_radius_m;
    }

    std::int32_t counts(double wound_m, std::int32_t origin) const {
        const double turns = wound_m / (2 * std::numbers::pi * pulley_radius_m);
        const double counts = std::round((reversed ? -turns : turns) * gear_ratio * counts_per_turn);
        return static_cast<std::int32_t>(std::clamp(origin + counts, -2147483648.0, 2147483647.0));
    }
};

// A cable that has come off or is torn, and a device that is not worn, let the motor draw in more than a pad could give way
// for: position against torque. The torque alone shows nothing, because the drive's current controller always makes it.
class SlackDetector {
  public:
    SlackDetector(double margin_m, double seconds) : margin_m_(margin_m), limit_s_(seconds) {}

    // `wound_m` since the cable was taut under pretension, `explained_m` what the pad gives way at this tension. True once the
    // rest has been above the margin for the time.
    bool slack(double wound_m, double explained_m, double step_s) {
        for_s_ = wound_m - explained_m > margin_m_ ? for_s_ + step_s : 0;
        return for_s_ >= limit_s_;
    }

  private:
    double margin_m_, limit_s_;
    double for_s_ = 0;
};

}  // namespace thimble
