// How many roots of  z^D (z^2 - a1 z + a0) + K (n2 z^2 + n1 z + n0)  lie outside a circle; for this room only. In double
// where that is enough, in Precise to be sure.
//
// On |z| = r both quadratics are z q(theta) with q = (c2 r + c0 / r) cos(theta) + c1 + j (c2 r - c0 / r) sin(theta): the sign of
// q's imaginary part does not change on the upper half, so that its argument is continuous there, and |q|^2 is a quadratic in
// cos(theta). Between the places where |f| = |g| the sum f + g turns with the greater one. The total turn is a whole number of
// half turns; the roots inside are what it counts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "common/math/portable.hpp"
#include "stability/precise_number.hpp"
#include "stability/sampled_loop.hpp"

namespace thimble {

template <class Real>
struct PulsePolynomial {
    double power = 0;                // D
    std::array<Real, 3> hand{};      // a0, -a1, 1: from the constant on
    std::array<Real, 3> feedback{};  // n0, n1, n2
    Real gain{};                     // K
};

// The characteristic polynomial of a sampled loop. Throws Error (usage) for what is none.
PulsePolynomial<Precise> pulse_polynomial(const SampledLoop& loop);

// T = count h + rest, where a rest within the rounding of T / h is none. Checks like pulse_polynomial.
struct WholeSteps {
    double count;
    Precise rest_s;
};
WholeSteps whole_steps(const SampledLoop& loop);

PulsePolynomial<double> in_doubles(const PulsePolynomial<Precise>& p);

template <class Real>
struct PolarNumber {
    Real size, angle;
};

template <class Real>
class Circle {
  public:
    Circle(const PulsePolynomial<Real>& p, const Real& radius) : p_(p), r_(radius) {
        using portable::pow;
        // Relative to z^D, which may be out of any range by itself.
        gain_ = p.gain * Real(pow(radius, Real(-p.power)));
    }

    // cos(theta) where both terms are of one size, from theta = 0 on.
    struct Changes {
        std::array<Real, 2> cosine{};
        std::size_t count = 0;
    };
    Changes changes() const {
        using std::sqrt;
        const auto [f2, f1, f0] = squared(p_.hand);
        const auto [g2, g1, g0] = squared(p_.feedback);
        const Real gg = gain_ * gain_, a = f2 - gg * g2, b = (f1 - gg * g1) / 2, c = f0 - gg * g0;
        Changes found;
        const Real discriminant = b * b - a * c;
        if (!(discriminant > 0)) return found;
        const Real q = b >= 0 ? Real(-b - sqrt(discriminant)) : Real(-b + sqrt(discriminant));
        if (a != 0) keep(found, Real(q / a));
        if (q != 0) keep(found, Real(c / q));
        if (found.count == 2 && found.cosine[0] < found.cosine[1])
            std::swap(found.cosine[0], found.cosine[1]);
        return found;
    }

    int roots_outside() const {
        using portable::acos;
        const Changes at = changes();
        std::array<Real, 4> theta{Real(0), pi_of<Real>(), pi_of<Real>(), pi_of<Real>()};
        for (std::size_t i = 0; i < at.count; ++i) theta[i + 1] = acos(at.cosine[i]);
        Real turned = pi_of<Real>();  // of the factor z
        for (std::size_t i = 0; i <= at.count; ++i)
            turned += turn_between(theta[i], theta[i + 1], i == 0, i == at.count);
        const double half_turns = to_double(turned / pi_of<Real>());
        return static_cast<int>(p_.power + 2 - std::round(half_turns));
    }

    // f and g at theta, both over z^(D + 1) without its angle.
    PolarNumber<Real> hand_at(const Real& theta) const { return polar(p_.hand, theta); }
    PolarNumber<Real> feedback_at(const Real& theta) const {
        const PolarNumber<Real> g = polar(p_.feedback, theta);
        return {g.size * gain_, g.angle};
    }

  private:
    std::array<Real, 3> squared(const std::array<Real, 3>& c) const {
        const Real sum = c[2] * r_ + c[0] / r_, difference = c[2] * r_ - c[0] / r_;
        return {4 * c[2] * c[0], 2 * c[1] * sum, c[1] * c[1] + difference * difference};
    }

    static void keep(Changes& found, const Real& cosine) {
        if (cosine > -1 && cosine < 1 && found.count < 2) found.cosine[found.count++] = cosine;
    }

    PolarNumber<Real> polar(const std::array<Real, 3>& c, const Real& theta) const {
        using portable::atan2, portable::cos, portable::sin, std::sqrt;
        const Real re = (c[2] * r_ + c[0] / r_) * cos(theta) + c[1], across = c[2] * r_ - c[0] / r_;
        const bool on_axis = theta == 0 || theta == pi_of<Real>();
        const Real im = on_axis ? Real(0) : Real(across * sin(theta));
        const Real side = across < 0 ? Real(-pi_of<Real>()) : pi_of<Real>();
        const Real angle = on_axis ? (re < 0 ? side : Real(0)) : Real(atan2(im, re));
        return {sqrt(Real(re * re + im * im)), angle};
    }

    // Of f + g, where |f| > |g| or |f| < |g| on the whole circle.
    Real turn_between(const Real& from, const Real& to, bool first, bool last) const {
        const Real middle = (from + to) / 2;
        const bool hand_leads = hand_at(middle).size >= feedback_at(middle).size;
        const Real end = added_angle(to, hand_leads, last), start = added_angle(from, hand_leads, first);
        return end - start;
    }

    // The argument of the leader at theta, and by how much the other term turns the sum.
    Real added_angle(const Real& theta, bool hand_leads, bool at_the_end) const {
        using portable::atan2, portable::cos, portable::sin;
        const PolarNumber<Real> f = hand_at(theta), g = feedback_at(theta);
        const Real angle_f = f.angle + Real(p_.power) * theta;
        const PolarNumber<Real> leader{hand_leads ? f.size : g.size, hand_leads ? angle_f : g.angle};
        const PolarNumber<Real> other{hand_leads ? g.size : f.size, hand_leads ? g.angle : angle_f};
        const Real apart = other.angle - leader.angle;
        // Where they change over they are of one size, whatever rounding says.
        Real ratio = at_the_end && leader.size > 0 ? Real(other.size / leader.size) : Real(1);
        if (ratio > 1) ratio = 1;
        return leader.angle + atan2(Real(ratio * sin(apart)), Real(1 + ratio * cos(apart)));
    }

    PulsePolynomial<Real> p_;
    Real r_;
    Real gain_{};
};

}  // namespace thimble
