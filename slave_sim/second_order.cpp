#include "slave_sim/second_order.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "common/math/portable.hpp"

namespace thimble {

struct SecondOrder::Response {
    double velocity_s;   // S
    double position_s2;  // Q
    double remainder;    // c
};

namespace {

constexpr double kNoTurn_s = std::numeric_limits<double>::infinity();

// The series is used for a t and w2 t^2 below these; beyond them the closed forms no longer cancel.
constexpr double kSeriesDamping = 1.5;
constexpr double kSeriesStiffness = 0.5;
// Above this decay of the slow mode, 1 - c keeps its digits.
constexpr double kSlowDecay = 0.5;

constexpr std::size_t kTerms = 26;

constexpr std::array<double, kTerms> inverse_factorials() {
    std::array<double, kTerms> values{};
    double factorial = 1;
    for (std::size_t k = 0; k < kTerms; ++k) {
        if (k > 0) factorial *= static_cast<double>(k);
        values[k] = 1 / factorial;
    }
    return values;
}

constexpr std::array<double, kTerms> kInverseFactorial = inverse_factorials();

// (1 - e^-z) / z
double decay_ratio(double z) { return z == 0 ? 1 : -portable::expm1(-z) / z; }

struct Series {
    double velocity;  // S / t
    double position;  // Q / t^2
};

// S = t sum (-1)^k h_k / (k+1)!,  Q = t^2 sum (-1)^k h_k / (k+2)!  with h_k = (a t) h_{k-1} - (w2 t^2)
// h_{k-2}, the complete symmetric polynomials of the two decay rates times t: one formula for real, double
// and complex rates.
Series series(double at, double wt2) {
    constexpr double kNegligible = 1e-19;
    double before = 0;
    double h = 1;
    double last = 1;
    double sign = 1;
    Series sum{1, 0.5};
    for (std::size_t k = 1; k + 2 < kTerms; ++k) {
        const double next = at * h - wt2 * before;
        before = h;
        h = next;
        sign = -sign;
        const double term = sign * h * kInverseFactorial[k + 1];
        sum.velocity += term;
        sum.position += sign * h * kInverseFactorial[k + 2];
        // Without damping every other term is zero, so one small term proves nothing.
        if (std::abs(term) + std::abs(last) < kNegligible) break;
        last = term;
    }
    return sum;
}

}  // namespace

SecondOrder::SecondOrder(double mass_kg, double damping_Ns_per_m, double stiffness_N_per_m)
    : damping_Ns_per_m_(damping_Ns_per_m),
      stiffness_N_per_m_(stiffness_N_per_m),
      per_mass_(1 / mass_kg),
      damping_per_s_(damping_Ns_per_m / mass_kg),
      stiffness_per_s2_(stiffness_N_per_m / mass_kg),
      natural_per_s_(std::sqrt(stiffness_per_s2_)),
      half_damping_per_s_(damping_per_s_ / 2) {
    assert(mass_kg > 0 && damping_Ns_per_m >= 0 && stiffness_N_per_m >= 0);
    // As a product: the difference of the squares would lose half the digits close to critical damping.
    const double discriminant =
        (half_damping_per_s_ - natural_per_s_) * (half_damping_per_s_ + natural_per_s_);
    oscillates_ = discriminant < 0;
    root_per_s_ = std::sqrt(std::abs(discriminant));
    const double fast_per_s = half_damping_per_s_ + root_per_s_;
    // s - w cancels; the product of the two rates is w2.
    slow_per_s_ = fast_per_s > 0 ? stiffness_per_s2_ / fast_per_s : 0;
}

// Real rates r1 <= r2 (equal at critical damping).
SecondOrder::Response SecondOrder::overdamped(double t) const {
    const double slow = slow_per_s_ * t;
    const double apart = 2 * root_per_s_ * t;
    const double ratio = decay_ratio(apart);
    const double faded = portable::exp(-slow);
    Response r{};
    r.velocity_s = t * faded * ratio;
    if (slow >= kSlowDecay) {
        r.remainder = faded * (0.5 + 0.5 * portable::exp(-apart) + half_damping_per_s_ * t * ratio);
        r.position_s2 = (1 - r.remainder) / stiffness_per_s2_;
    } else {
        r.position_s2 = t * (decay_ratio(slow) - decay_ratio(slow + apart)) / (2 * root_per_s_);
        r.remainder = 1 - stiffness_per_s2_ * r.position_s2;
    }
    return r;
}

SecondOrder::Response SecondOrder::underdamped(double t) const {
    const double angle = root_per_s_ * t;
    const double sine_s = t * (portable::sin(angle) / angle);  // sin(w t) / w
    const double faded = portable::exp(-half_damping_per_s_ * t);
    Response r{};
    r.velocity_s = faded * sine_s;
    r.remainder = faded * (portable::cos(angle) + half_damping_per_s_ * sine_s);
    r.position_s2 = (1 - r.remainder) / stiffness_per_s2_;
    return r;
}

Propagator SecondOrder::propagator(double duration_s) const {
    assert(duration_s >= 0);
    const double t = duration_s;
    const double at = damping_per_s_ * t;
    const double wt2 = stiffness_per_s2_ * t * t;
    Response r{};
    if (at < kSeriesDamping && wt2 < kSeriesStiffness) {
        const Series sum = series(at, wt2);
        r.velocity_s = t * sum.velocity;
        r.position_s2 = t * t * sum.position;
        r.remainder = 1 - stiffness_per_s2_ * r.position_s2;
    } else {
        r = oscillates_ ? underdamped(t) : overdamped(t);
    }
    return {t, r.remainder, r.velocity_s, r.velocity_s + damping_per_s_ * r.position_s2, r.position_s2};
}

Inflections SecondOrder::inflections(double v0, double a0) const {
    if (oscillates_) {
        // e^(-a t / 2) (a0 cos(w t) - (a/2 a0 + w2 v0) sin(w t) / w)
        const double half_turn_s = std::numbers::pi / root_per_s_;
        const double slope = half_damping_per_s_ * a0 + stiffness_per_s2_ * v0;
        // The root of the smaller angle: taking half a turn off it later would cost digits near critical
        // damping.
        const double side = slope < 0 ? -1 : 1;
        double first_s = portable::atan2(side * a0 * root_per_s_, side * slope) / root_per_s_;
        if (first_s <= 0) first_s += half_turn_s;
        return {first_s, half_turn_s};
    }
    // Two exponentials cross at most once: e^(2 w t) = 1 + 2 w q. At critical damping t = q.
    const double q_s = a0 / (slow_per_s_ * a0 + stiffness_per_s2_ * v0);
    if (!(q_s > 0)) return {kNoTurn_s, kNoTurn_s};
    const double apart_per_s = 2 * root_per_s_;
    return {apart_per_s > 0 ? portable::log1p(apart_per_s * q_s) / apart_per_s : q_s, kNoTurn_s};
}

// x = center + e^(-a t / 2) (C cos(w t) + D sin(w t)), with the equilibrium w2 center = a0 + a v0.
Swing SecondOrder::swing(double v0, double a0) const {
    const double center_m = (a0 + damping_per_s_ * v0) / stiffness_per_s2_;
    const double cosine_m = -center_m;
    const double sine_m = (v0 + half_damping_per_s_ * cosine_m) / root_per_s_;
    return {center_m, std::sqrt(cosine_m * cosine_m + sine_m * sine_m), half_damping_per_s_};
}

}  // namespace thimble
