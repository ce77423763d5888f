// The same loop as a computer closes it: position sampled every h, force held for h (zero-order hold), T = d h + tau', all exact.
//
//     x_{k+1} = Phi x_k - Gam0 u_{k-d} - Gam1 u_{k-d-1},  u_k = K x_k
//     z^D (z^2 - a1 z + a0) + K (n2 z^2 + n1 z + n0) = 0,  D = d (tau' = 0, n2 = 0) or d + 1
//
// (Astrom and Wittenmark, Computer-Controlled Systems, section 2.3.) Stable while the spectral radius, the greatest |z|, is
// below one; it grows by ln(radius) / h. How many roots lie outside a circle is counted exactly for any D: along the circle
// one of the two terms outweighs the other, and the places where they change over are roots of a quadratic in cos(theta).
// Meaningless input throws Error (usage), also a step outside 1e-9 to 1e3 s and a delay of more than 1e8 steps.
#pragma once

#include <optional>

#include "stability/delayed_loop.hpp"

namespace thimble {

struct SampledLoop {
    HeldMass hand;
    double stiffness_N_per_m = 0;  // K
    double delay_s = 0;            // T
    double step_s = 0;             // h
};

struct DominantMode {
    double radius = 0;        // |z|
    double angle_rad = 0;     // of z, 0 to pi
    double growth_per_s = 0;  // ln(radius) / h
};
DominantMode dominant_mode(const SampledLoop& loop);

// Roots outside the unit circle.
int growing_modes(const SampledLoop& loop);

// The stiffness at which this sampled loop becomes unstable; `stiffness_N_per_m` is not read. Its angle per step too. Zero for an
// undamped hand that the least stiffness makes swing up.
struct SampledLimit {
    double stiffness_N_per_m = 0;
    double angle_rad = 0;
};
SampledLimit critical_sampled_stiffness(const SampledLoop& loop);

// How many steps of delay (a real number; a whole number of them is used) the loop bears: d* = arg(-K num / den) / theta where
// |den| = K |num| on the unit circle. Negative: unstable without any delay. Nothing: no number of steps is between stable and
// unstable, whichever it is (growing_modes). `delay_s` is not read.
struct CriticalSteps {
    double steps = 0;
    double angle_rad = 0;
};
std::optional<CriticalSteps> critical_steps(const SampledLoop& loop);

// A spring behind d steps and a hold is passive for any passive hand up to 2 b / (h (2d + 1)), b the damping at the handle
// (Colgate and Schenkel 1997 for d = 0). For T = d h only; here with T/h for d.
double passive_stiffness_N_per_m(const SampledLoop& loop);

// The half-sample rule: a hold of period h acts like h/2 more of delay. Critical stiffness of the continuous loop with T + h/2.
double half_sample_stiffness_N_per_m(const SampledLoop& loop);

}  // namespace thimble
