#include "stability/sampled_loop.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/math/portable.hpp"
#include "stability/circle_count.hpp"

namespace thimble {
namespace {

using PrecisePulse = PulsePolynomial<Precise>;
using Zed = ComplexOf<Precise>;

// Doubles find the crossing, Precise confirms it on both sides, or searches itself where doubles were wrong.
constexpr double kFirstWidth = 1e-11, kMargin = 1e-9;

template <class Real>
struct Between {
    Real low, high;
};

template <class Real, class Above>
Between<Real> halved(Between<Real> range, double width, const Above& above) {
    constexpr int kMost = 400;
    for (int i = 0; i < kMost && range.high - range.low > range.high * Real(width); ++i) {
        const Real middle = (range.low + range.high) / 2;
        (above(middle) ? range.high : range.low) = middle;
    }
    return range;
}

template <class Real>
Between<Real> radius_range(const PulsePolynomial<Real>& p, double width) {
    using portable::exp;
    const auto none_outside = [&](const Real& r) { return Circle<Real>(p, r).roots_outside() <= 0; };
    constexpr int kMost = 60;
    const bool shrinks = none_outside(Real(1));
    Between<Real> range{Real(1), Real(1)};
    Real exponent = Real(1) / Real(p.power + 2);
    for (int i = 0; i < kMost; ++i, exponent *= 2) {
        const Real radius = exp(Real(shrinks ? Real(-exponent) : exponent));
        (shrinks ? range.low : range.high) = radius;
        if (none_outside(radius) != shrinks) break;
        (shrinks ? range.high : range.low) = radius;
    }
    return halved(range, width, none_outside);
}

bool confirmed(const PrecisePulse& p, const Between<double>& radius) {
    return Circle<Precise>(p, Precise(radius.low) * (1 - kMargin)).roots_outside() > 0 &&
           Circle<Precise>(p, Precise(radius.high) * (1 + kMargin)).roots_outside() == 0;
}

// |f + g|^2 / (|f| + |g|)^2.
Precise misfit(const Circle<Precise>& circle, double power, const Precise& theta) {
    const auto f = circle.hand_at(theta), g = circle.feedback_at(theta);
    const Precise sum = f.size + g.size, apart = g.angle - f.angle - power * theta;
    return (f.size * f.size + g.size * g.size + 2 * f.size * g.size * cos(apart)) / (sum * sum);
}

// The angle of the root that lies on this circle, or next to it.
Precise angle_on(const PrecisePulse& p, const Circle<Precise>& circle) {
    std::vector<Precise> candidates{Precise(0), pi_of<Precise>()};
    const auto changes = circle.changes();
    for (std::size_t i = 0; i < changes.count; ++i) candidates.push_back(acos(changes.cosine[i]));
    return *std::min_element(candidates.begin(), candidates.end(), [&](const Precise& a, const Precise& b) {
        return misfit(circle, p.power, a) < misfit(circle, p.power, b);
    });
}

Zed quadratic(const std::array<Precise, 3>& c, const Zed& z) {
    return z * (z * c[2] + Zed{c[1], 0}) + Zed{c[0], 0};
}

// Newton's method on  den + K num z^-D.
Zed polished(const PrecisePulse& p, const Zed& start) {
    constexpr int kSteps = 6;
    Zed z = start;
    for (int i = 0; i < kSteps; ++i) {
        const Precise size = pow(sqrt(z.square()), Precise(-p.power)), angle = -p.power * atan2(z.im, z.re);
        const Zed late = Zed{size * cos(angle), size * sin(angle)} * p.gain;
        const Zed num = quadratic(p.feedback, z);
        const Zed slope =
            z * (2 * p.hand[2]) + Zed{p.hand[1], 0} +
            late * (z * (2 * p.feedback[2]) + Zed{p.feedback[1], 0} - num * Precise(p.power) / z);
        if (slope.square() == 0) return start;
        z = z - (quadratic(p.hand, z) + late * num) / slope;
    }
    return (z - start).square() <= start.square() * Precise(1e-14) ? z : start;
}

Between<Precise> certain_radius(const PrecisePulse& p) {
    const Between<double> quick = radius_range(in_doubles(p), kFirstWidth);
    if (confirmed(p, quick)) return {Precise(quick.low), Precise(quick.high)};
    return radius_range(p, 1e-16);
}

template <class Real>
bool unstable_at(PulsePolynomial<Real> p, const Real& stiffness) {
    p.gain = stiffness;
    return Circle<Real>(p, Real(1)).roots_outside() > 0;
}

// From a first guess to a range.
template <class Real>
Between<Real> stiffness_range(const PulsePolynomial<Real>& p, double guess, double width) {
    constexpr int kMost = 120;
    Between<Real> range{Real(guess), Real(guess)};
    for (int i = 0; i < kMost && !unstable_at(p, range.high); ++i) range.high *= 2;
    for (int i = 0; i < kMost && unstable_at(p, range.low); ++i) range.low /= 2;
    return halved(range, width, [&](const Real& stiffness) { return unstable_at(p, stiffness); });
}

// On the unit circle: D theta + arg den - arg num is an odd multiple of pi. Secants from `theta` on.
Precise crossing_angle(const Circle<Precise>& unit, double power, const Precise& theta) {
    const Precise turn = 2 * pi_of<Precise>();
    const auto excess = [&](const Precise& at) {
        const Precise phase =
            unit.hand_at(at).angle + power * at - unit.feedback_at(at).angle - pi_of<Precise>();
        return Precise(phase - turn * round(Precise(phase / turn)));
    };
    Precise before = theta * (1 - Precise(1e-12)), at = theta;
    Precise excess_before = excess(before);
    for (int i = 0; i < 8; ++i) {
        const Precise now = excess(at), rise = now - excess_before;
        if (rise == 0 || abs(now) < Precise(1e-50)) break;
        const Precise next = at - now * (at - before) / rise;
        if (!(next > 0) || next > pi_of<Precise>()) return theta;
        before = at;
        excess_before = now;
        at = next;
    }
    return at;
}

double first_guess(const SampledLoop& loop) {
    const double guess = half_sample_stiffness_N_per_m(loop);
    return guess > 0 && std::isfinite(guess) ? guess : loop.hand.mass_kg / (loop.step_s * loop.step_s) * 1e-3;
}

// Steps so long that the feedback outweighs the hand at z = -1: there the delay has no frequency to be reckoned with.
std::optional<CriticalSteps> by_trial(PrecisePulse p) {
    constexpr int kMost = 4096;
    for (int steps = 1; steps <= kMost; ++steps) {
        p.power = steps;
        if (Circle<Precise>(p, Precise(1)).roots_outside() > 0) {
            return CriticalSteps{steps - 1.0, to_double(pi_of<Precise>())};
        }
    }
    return std::nullopt;
}

// Close to `stiffness` (a middle of a narrow range), to all digits.
SampledLimit polished_limit(PrecisePulse p, const Precise& stiffness) {
    p.gain = stiffness;
    const Circle<Precise> unit(p, Precise(1));
    const Precise found = angle_on(p, unit);
    const Precise theta = found < pi_of<Precise>() ? crossing_angle(unit, p.power, found) : found;
    const Precise better = stiffness * unit.hand_at(theta).size / unit.feedback_at(theta).size;
    if (abs(better - stiffness) > stiffness * Precise(1e-7)) return {to_double(stiffness), to_double(found)};
    return {to_double(better), to_double(theta)};
}

}  // namespace

DominantMode dominant_mode(const SampledLoop& loop) {
    const PrecisePulse p = pulse_polynomial(loop);
    const Between<Precise> range = certain_radius(p);
    const Precise radius = (range.low + range.high) / 2;
    const Precise angle = angle_on(p, Circle<Precise>(p, radius));
    const Zed z = polished(p, {radius * cos(angle), radius * sin(angle)});
    const Precise size = sqrt(z.square());
    return {to_double(size), to_double(abs(Precise(atan2(z.im, z.re)))), to_double(log(size) / loop.step_s)};
}

int growing_modes(const SampledLoop& loop) {
    return Circle<Precise>(pulse_polynomial(loop), Precise(1)).roots_outside();
}

SampledLimit critical_sampled_stiffness(const SampledLoop& loop) {
    SampledLoop any = loop;
    any.stiffness_N_per_m = 1;
    const PrecisePulse p = pulse_polynomial(any);
    const double guess = first_guess(any);
    constexpr double kNothing = 1e-15;
    if (unstable_at(p, Precise(guess) * kNothing)) return {0, 0};
    const Between<double> quick = stiffness_range(in_doubles(p), guess, kFirstWidth);
    const bool sure = !unstable_at(p, Precise(quick.low) * (1 - kMargin)) &&
                      unstable_at(p, Precise(quick.high) * (1 + kMargin));
    const Between<Precise> range =
        sure ? Between<Precise>{Precise(quick.low), Precise(quick.high)} : stiffness_range(p, guess, 1e-16);
    return polished_limit(p, (range.low + range.high) / 2);
}

std::optional<CriticalSteps> critical_steps(const SampledLoop& loop) {
    SampledLoop undelayed = loop;
    undelayed.delay_s = 0;
    const PrecisePulse p = pulse_polynomial(undelayed);
    const Circle<Precise> unit(p, Precise(1));
    const bool unstable_at_once = unit.roots_outside() > 0;
    const auto changes = unit.changes();
    const bool hand_leads_first = unit.hand_at(0).size > unit.feedback_at(0).size;
    // Crossings outward are where the hand takes over again.
    const std::size_t outward = hand_leads_first ? 1 : 0;
    const Precise pi = pi_of<Precise>();
    if (!unstable_at_once && unit.hand_at(pi).size < unit.feedback_at(pi).size) return by_trial(p);
    if (changes.count <= outward) return std::nullopt;
    const Precise theta = acos(changes.cosine[outward]);
    Precise turn = unit.feedback_at(theta).angle + pi - unit.hand_at(theta).angle;
    turn -= 2 * pi * ceil(Precise((turn - pi) / (2 * pi)));  // to (-pi, pi]
    if (turn < 0 && !unstable_at_once) turn += 2 * pi;
    return CriticalSteps{to_double(turn / theta), to_double(theta)};
}

double passive_stiffness_N_per_m(const SampledLoop& loop) {
    return loop.hand.damping_Ns_per_m / (loop.delay_s + loop.step_s / 2);
}

double half_sample_stiffness_N_per_m(const SampledLoop& loop) {
    return critical_stiffness(loop.hand, loop.delay_s + loop.step_s / 2).stiffness_N_per_m;
}

}  // namespace thimble
