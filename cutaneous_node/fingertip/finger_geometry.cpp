#include "cutaneous_node/fingertip/finger_geometry.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace thimble {

FingerGeometry::FingerGeometry(double cable_angle_rad)
    : cosine_(std::cos(cable_angle_rad)), sine_(std::sin(cable_angle_rad)), towards_x_{}, towards_y_{} {
    assert(cosine_ > 0 && sine_ > 0);
    for (std::size_t i = 0; i < kCablesPerFinger; ++i) {
        const double azimuth_rad = (0.5 + 2.0 / 3 * static_cast<double>(i)) * std::numbers::pi;
        towards_x_[i] = std::cos(azimuth_rad);
        towards_y_[i] = std::sin(azimuth_rad);
    }
}

CableTensions FingerGeometry::tensions_N(const PadForce& force) const {
    const double even_N = std::max(force.normal_N, 0.0) / (3 * cosine_);
    CableTensions uneven_N{};
    double least_N = 0;
    for (std::size_t i = 0; i < kCablesPerFinger; ++i) {
        uneven_N[i] = 2 * (force.x_N * towards_x_[i] + force.y_N * towards_y_[i]) / (3 * sine_);
        least_N = std::min(least_N, uneven_N[i]);
    }
    const double share = even_N + least_N < 0 ? even_N / -least_N : 1;
    CableTensions tensions_N{};
    for (std::size_t i = 0; i < kCablesPerFinger; ++i) {
        tensions_N[i] = std::max(even_N + share * uneven_N[i], 0.0);
    }
    return tensions_N;
}

PadForce FingerGeometry::force(const CableTensions& tensions_N) const {
    PadForce force;
    for (std::size_t i = 0; i < kCablesPerFinger; ++i) {
        force.normal_N += cosine_ * tensions_N[i];
        force.x_N += sine_ * tensions_N[i] * towards_x_[i];
        force.y_N += sine_ * tensions_N[i] * towards_y_[i];
    }
    return force;
}

}  // namespace thimble
