// How many roots of the delayed loop lie right of a vertical line. Inside this room's sources only.
//
// With s = line + s' the loop keeps its form: m s'^2 + b' s' + k' + (K' + B' s') e^(-s'T), only that the coefficients may now be
// negative. Without delay (K', B' kept) its two roots are known; with more delay one pair crosses at each T_j, so the count at T is
// closed form. It falls, step by step, as the line moves to the right.
#pragma once

#include <vector>

#include "stability/delayed_loop.hpp"
#include "stability/precise_number.hpp"

namespace thimble {

struct ShiftedLoop {
    Precise mass, damping, stiffness, loop_stiffness, loop_damping;

    static ShiftedLoop by(const DelayedLoop& loop, double delay_s, const Precise& line) {
        const Precise m(loop.hand.mass_kg), b(loop.hand.damping_Ns_per_m), k(loop.hand.stiffness_N_per_m);
        const Precise K(loop.stiffness_N_per_m), B(loop.delayed_damping_Ns_per_m);
        const Precise faded = exp(Precise(-line * delay_s));
        return {m, b + 2 * m * line, k + line * (b + m * line), (K + B * line) * faded, B * faded};
    }

    // Delta at s' = 0, as a function of the line. Its zeros are the real roots of Delta.
    Precise on_the_real_axis() const { return stiffness + loop_stiffness; }
};

// All crossings at one frequency: at first_delay, below one period, and then every 2 pi / w.
struct PreciseFamily {
    Precise first_delay, frequency;
    int direction;
};
// e^(jwT) = -(K + jBw) / P(jw), T in [0, 2 pi / w).
inline Precise first_delay_of(const ShiftedLoop& loop, const Precise& w) {
    const ComplexOf<Precise> loop_part{-loop.loop_stiffness, -loop.loop_damping * w};
    const ComplexOf<Precise> conjugate{loop.stiffness - loop.mass * w * w, -loop.damping * w};
    const ComplexOf<Precise> turn = loop_part * conjugate;
    const Precise angle = atan2(turn.im, turn.re);
    return (angle < 0 ? Precise(angle + 2 * pi_of<Precise>()) : angle) / w;
}

// None, one or two, the higher frequency first.
// u = w^2:  m^2 u^2 + (b^2 - B^2 - 2mk) u + k^2 - K^2 = 0. Crossings above the parabola's vertex destabilise.
inline std::vector<PreciseFamily> precise_families(const ShiftedLoop& l) {
    const Precise mm = l.mass * l.mass;
    const Precise half =
        (l.damping - l.loop_damping) * (l.damping + l.loop_damping) / 2 - l.mass * l.stiffness;
    const Precise constant = (l.stiffness - l.loop_stiffness) * (l.stiffness + l.loop_stiffness);
    const Precise discriminant = half * half - mm * constant;
    std::vector<PreciseFamily> families;
    if (discriminant <= 0) return families;
    const Precise root = sqrt(discriminant);
    // Each in the form that does not cancel.
    const Precise upper = half <= 0 ? Precise((root - half) / mm) : Precise(-constant / (half + root));
    const Precise lower = half <= 0 ? Precise(constant / (root - half)) : Precise(-(half + root) / mm);
    families.reserve(2);
    for (const int direction : {1, -1}) {
        const Precise& square = direction > 0 ? upper : lower;
        if (square <= 0) continue;
        const Precise w = sqrt(square);
        families.push_back({first_delay_of(l, w), w, direction});
    }
    return families;
}

// Crossings of one family at delays below `delay`. A whole number, and far to the left a large one.
inline double crossings_before(const PreciseFamily& family, const Precise& delay) {
    if (delay <= family.first_delay) return 0;
    const Precise turns = (delay - family.first_delay) * family.frequency / (2 * pi_of<Precise>());
    const Precise whole = floor(turns);
    return to_double(whole) + (whole == turns ? 0 : 1);
}

inline double roots_right_of(const ShiftedLoop& loop, const Precise& delay) {
    const Precise damping = loop.damping + loop.loop_damping;
    double count = loop.on_the_real_axis() < 0 ? 1 : (damping < 0 ? 2 : 0);
    for (const PreciseFamily& family : precise_families(loop)) {
        count += 2 * family.direction * crossings_before(family, delay);
    }
    return count;
}

}  // namespace thimble
