// The delayed force loop of a held mass in continuous time:
//
//     Delta(s) = m s^2 + b s + k + (K + B_v s) e^(-sT)
//
// K is the fixture's stiffness at the handle (position scale x force scale x stiffness at the needle), B_v the viscosity of what
// lies before it, felt just as late; T the delay of the whole way round. Roots cross the imaginary axis where
// |P(jw)|^2 = K^2 + B_v^2 w^2, a quadratic in w^2, at the delays T_j = (theta + 2 pi j) / w: Walton and Marshall 1987, Cooke and
// van den Driessche 1986. All results are correct to 1e-12 over ten decades of every parameter, except where two crossings
// merge within the last digits of the input. Meaningless input throws Error (usage).
#pragma once

#include <cstddef>
#include <vector>

#include "stability/critical_delay.hpp"

namespace thimble {

struct DelayedLoop {
    HeldMass hand;
    double stiffness_N_per_m = 0;         // K
    double delayed_damping_Ns_per_m = 0;  // B_v
};

void require_meaningful(const HeldMass& held);
void require_meaningful(const DelayedLoop& loop);
void require_delay(double delay_s);  // finite, 0 to 1e6 s
// Both, and a delay of less than 1e8 rad at the crossing frequencies.
void require_countable(const DelayedLoop& loop, double delay_s);

struct RootCrossing {
    double delay_s = 0;
    double frequency_rad_per_s = 0;
    int direction = 0;  // +1: with more delay a pair of roots becomes unstable, -1: stable
    int unstable_roots_after = 0;
};
// In order of delay, up to and including `longest_s`; at most `most` of them.
std::vector<RootCrossing> crossings(const DelayedLoop& loop, double longest_s, std::size_t most);

// Roots to the right of the imaginary axis; those on it are not counted.
int unstable_roots(const DelayedLoop& loop, double delay_s);

// Delays from `from_s` up to `to_s` (infinite: any longer one) for which no root is unstable. The first begins at zero.
struct StableDelays {
    double from_s = 0;
    double to_s = 0;
};
// In order. At most `most`, of which a loop close to its delay-independent stiffness has many.
std::vector<StableDelays> stable_delays(const DelayedLoop& loop, std::size_t most);

// The first crossing; see CriticalPoint.
CriticalPoint critical_point(const DelayedLoop& loop);

// Up to this K, every delay is stable: b sqrt(4mk - b^2) / (2m), or k where b^2 >= 2mk.
double delay_independent_stiffness_N_per_m(const HeldMass& held);

struct DominantRoot {
    double real_per_s = 0;
    double imaginary_rad_per_s = 0;  // >= 0; the conjugate is a root too
};
// The root of Delta with the greatest real part: that line to whose right no root lies, found by counting roots right of it (the
// crossings of the loop shifted by it), then Newton.
DominantRoot rightmost_root(const DelayedLoop& loop, double delay_s);

// The stiffness K at which the loop becomes unstable with this delay: psi(w) = arg P(jw) + w T is an odd multiple of pi there, and
// K the least |P(jw)| of all such w. Infinite without delay (frequency zero). At least b / T.
struct CriticalStiffness {
    double stiffness_N_per_m = 0;
    double frequency_rad_per_s = 0;
};
CriticalStiffness critical_stiffness(const HeldMass& held, double delay_s);

// Fingertip and visual feedback leave the handle alone; what remains is the person's own loop, x_d' = -g (F_perceived - F_ref)
// after `lag_s` = delay + device + reaction:  s P(s) + k L e^(-s lag) = 0 with L = g K. Returns L* in 1/s and its frequency.
// Throws Error (usage) for a hand without spring or without damping too.
struct PerceptualLimit {
    double gain_per_s = 0;
    double frequency_rad_per_s = 0;
};
PerceptualLimit perceptual_limit(const HeldMass& held, double lag_s);

}  // namespace thimble
