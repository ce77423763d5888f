#include "experiment/critical_delay.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace thimble {
namespace {

constexpr double kNoLimit_s = std::numeric_limits<double>::infinity();
constexpr int kGridPoints = 4000;
constexpr int kHalvings = 100;

// D(jw) of the held handle.
std::complex<double> stiffness_at(const HeldHandle& h, double w) {
    const std::complex<double> s(0, w);
    const std::complex<double> grip = h.grip_stiffness_N_per_m + h.grip_damping_Ns_per_m * s;
    const std::complex<double> arm =
        h.arm_mass_kg * s * s + h.arm_damping_Ns_per_m * s + h.arm_stiffness_N_per_m;
    return h.handle_mass_kg * s * s + h.handle_damping_Ns_per_m * s + grip * arm / (grip + arm);
}

// The least T > 0 with D + K e^(-jwT) = 0.
double delay_at_root_s(std::complex<double> stiffness, double w) {
    const double phase = -std::arg(-stiffness);
    return (phase < 0 ? phase + 2 * std::numbers::pi : phase) / w;
}

template <class Function>
double bisect(double low, double high, Function&& excess) {
    const bool rises = excess(high) > 0;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = low + (high - low) / 2;
        ((excess(middle) > 0) == rises ? high : low) = middle;
    }
    return low + (high - low) / 2;
}

}  // namespace

// m^2 w^4 + (b^2 - 2mk) w^2 + k^2 - K^2 = 0; theta = atan2(b w, m w^2 - k).
double critical_delay_s(const HeldMass& held, double loop_stiffness_N_per_m) {
    const double m = held.mass_kg, b = held.damping_Ns_per_m, k = held.stiffness_N_per_m;
    const double K = loop_stiffness_N_per_m;
    const double B = b * b - 2 * m * k, C = (k - K) * (k + K);
    const double discriminant = B * B - 4 * m * m * C;
    if (discriminant < 0) return kNoLimit_s;
    // The form that does not cancel.
    const double square =
        B <= 0 ? (-B + std::sqrt(discriminant)) / (2 * m * m) : 2 * C / (-B - std::sqrt(discriminant));
    if (!(square > 0)) return kNoLimit_s;
    const double w = std::sqrt(square);
    return std::atan2(b * w, m * square - k) / w;
}

double critical_delay_s(const HeldHandle& held, double loop_stiffness_N_per_m) {
    const auto excess = [&](double w) { return std::abs(stiffness_at(held, w)) - loop_stiffness_N_per_m; };
    // Beyond the last root the handle's mass alone outweighs the loop.
    double last = 1;
    while (held.handle_mass_kg * last * last < 4 * (loop_stiffness_N_per_m + held.grip_stiffness_N_per_m) +
                                                   4 * held.grip_damping_Ns_per_m * last) {
        last *= 2;
    }
    const double first = 1e-2, ratio = std::pow(last / first, 1.0 / kGridPoints);
    double least_s = kNoLimit_s, low = first;
    for (int i = 0; i < kGridPoints; ++i, low *= ratio) {
        const double high = low * ratio;
        if ((excess(low) > 0) == (excess(high) > 0)) continue;
        const double w = bisect(low, high, excess);
        least_s = std::min(least_s, delay_at_root_s(stiffness_at(held, w), w));
    }
    return least_s;
}

}  // namespace thimble
