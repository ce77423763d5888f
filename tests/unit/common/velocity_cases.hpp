// Every velocity estimator, and samples to feed it.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "common/velocity_estimator.hpp"

namespace thimble::test {

inline constexpr double kQuantum_m = 3e-5;

inline VelocitySettings velocity_of(VelocityMethod method, FoawFit fit = FoawFit::kBest) {
    VelocitySettings settings;
    settings.method = method;
    settings.fit = fit;
    settings.quantum_m = kQuantum_m;
    return settings;
}

inline std::vector<VelocitySettings> every_velocity_setting() {
    return {velocity_of(VelocityMethod::kLowPass),
            velocity_of(VelocityMethod::kRaw),
            velocity_of(VelocityMethod::kWindowed),
            velocity_of(VelocityMethod::kFoaw, FoawFit::kBest),
            velocity_of(VelocityMethod::kFoaw, FoawFit::kEnd),
            velocity_of(VelocityMethod::kKalman)};
}

inline std::string name_of(const VelocitySettings& settings) {
    std::string name{kVelocityMethodNames[static_cast<std::size_t>(settings.method)]};
    if (settings.method == VelocityMethod::kFoaw) name += settings.fit == FoawFit::kEnd ? "_end" : "_best";
    return name;
}

inline double quantised_m(double position_m) { return std::round(position_m / kQuantum_m) * kQuantum_m; }

}  // namespace thimble::test
