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

    static ShiftedLoop by(const DelayedLoop& loop, double delay_s, const Precise& line);
    // Delta at s' = 0, as a function of the line. Its zeros are the real roots of Delta.
    Precise on_the_real_axis() const { return stiffness + loop_stiffness; }
};

// All crossings at one frequency: at first_delay, below one period, and then every 2 pi / w.
struct PreciseFamily {
    Precise first_delay, frequency;
    int direction;
};
// None, one or two, the higher frequency first.
std::vector<PreciseFamily> precise_families(const ShiftedLoop& loop);

// Crossings of one family at delays below `delay`. A whole number, and far to the left a large one.
double crossings_before(const PreciseFamily& family, const Precise& delay);
double roots_right_of(const ShiftedLoop& loop, const Precise& delay);

}  // namespace thimble
