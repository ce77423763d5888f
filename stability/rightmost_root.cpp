// The rightmost root of the delayed loop.
#include <cmath>
#include <utility>

#include "stability/delayed_loop.hpp"
#include "stability/root_count.hpp"

namespace thimble {
namespace {

using Root = ComplexOf<Precise>;

struct LinePair {
    Precise left, right;  // roots right of the first, none right of the second
};

Precise two_to(int exponent) { return ldexp(Precise(1), exponent); }

// Delta and its derivative.
std::pair<Root, Root> value_and_slope(const DelayedLoop& loop, double delay_s, const Root& s) {
    const Precise m(loop.hand.mass_kg), b(loop.hand.damping_Ns_per_m), k(loop.hand.stiffness_N_per_m);
    const Precise K(loop.stiffness_N_per_m), B(loop.delayed_damping_Ns_per_m);
    const Precise faded = exp(Precise(-s.re * delay_s)), angle = s.im * delay_s;
    const Root late{faded * cos(angle), -faded * sin(angle)};
    const Root force = Root{K + B * s.re, B * s.im} * late;
    const Root value = s * (s * m + Root{b, 0}) + Root{k, 0} + force;
    return {value, s * (2 * m) + Root{b, 0} + late * B - force * Precise(delay_s)};
}

DominantRoot undelayed(const DelayedLoop& loop) {
    const Precise m(loop.hand.mass_kg),
        b = Precise(loop.hand.damping_Ns_per_m) + loop.delayed_damping_Ns_per_m;
    const Precise k = Precise(loop.hand.stiffness_N_per_m) + loop.stiffness_N_per_m;
    const Precise discriminant = b * b - 4 * m * k;
    if (discriminant < 0)
        return {to_double(0 - b / (2 * m)),  // no -0
                to_double(sqrt(Precise(-discriminant)) / (2 * m))};
    return {to_double(-2 * k / (b + sqrt(discriminant))), 0};
}

// No root of positive real part is farther from zero: m |s|^2 <= (b + B) |s| + k + K.
Precise root_bound(const DelayedLoop& loop) {
    const Precise m(loop.hand.mass_kg),
        b = Precise(loop.hand.damping_Ns_per_m) + loop.delayed_damping_Ns_per_m;
    const Precise k = Precise(loop.hand.stiffness_N_per_m) + loop.stiffness_N_per_m;
    return (b + sqrt(Precise(b * b + 4 * m * k))) / (2 * m);
}

LinePair bracket(const DelayedLoop& loop, double delay_s) {
    constexpr int kSmallest = 200, kWider = 8;  // powers of two
    const auto right_of = [&](const Precise& line) {
        return roots_right_of(ShiftedLoop::by(loop, delay_s, line), delay_s) > 0;
    };
    const Precise bound = root_bound(loop);
    Precise far = bound * Precise(1.0625), near = far;
    if (right_of(0)) {
        for (int i = 0; i < kSmallest && !right_of(near); i += kWider)
            far = std::exchange(near, near / two_to(kWider));
        return {near, far};
    }
    const Precise slow = Precise(1) / delay_s;
    near = far = slow < bound ? slow : bound;
    if (right_of(-far)) {
        for (int i = 0; i < kSmallest && right_of(-near); i += kWider)
            far = std::exchange(near, near / two_to(kWider));
    } else {
        while (!right_of(-far)) near = std::exchange(far, far * 2);
    }
    return {-far, -near};
}

// On the line between, the crossing frequency whose root is nearest: Delta is least there.
Root nearest_root(const DelayedLoop& loop, double delay_s, const LinePair& lines) {
    const Precise line = (lines.left + lines.right) / 2;
    Root best{line, 0};
    Precise least = value_and_slope(loop, delay_s, best).first.square();
    for (const PreciseFamily& family : precise_families(ShiftedLoop::by(loop, delay_s, line))) {
        const Root candidate{line, family.frequency};
        const Precise size = value_and_slope(loop, delay_s, candidate).first.square();
        if (size < least) {
            least = size;
            best = candidate;
        }
    }
    return best;
}

Root polished(const DelayedLoop& loop, double delay_s, const Root& start) {
    constexpr int kSteps = 6;
    Root s = start;
    for (int i = 0; i < kSteps; ++i) {
        const auto [value, slope] = value_and_slope(loop, delay_s, s);
        if (slope.square() == 0) return start;
        s = s - value / slope;
    }
    // A double root: what the lines say is better than what Newton makes of it.
    const Precise moved = (s - start).square(), size = start.square();
    return moved <= size * Precise(1e-12) ? s : start;
}

}  // namespace

DominantRoot rightmost_root(const DelayedLoop& loop, double delay_s) {
    require_countable(loop, delay_s);
    if (delay_s == 0) return undelayed(loop);
    constexpr int kHalvings = 70;
    LinePair lines = bracket(loop, delay_s);
    for (int i = 0; i < kHalvings; ++i) {
        const Precise middle = (lines.left + lines.right) / 2;
        const bool right = roots_right_of(ShiftedLoop::by(loop, delay_s, middle), delay_s) > 0;
        (right ? lines.left : lines.right) = middle;
    }
    const Root root = polished(loop, delay_s, nearest_root(loop, delay_s, lines));
    return {to_double(root.re), std::abs(to_double(root.im))};
}

}  // namespace thimble
