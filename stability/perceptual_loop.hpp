// A person who corrects by what fingertips or eyes say, as the loop runs; the theory without pauses is perceptual_limit().
//
//     m x" + b x' + k (x - x_d) = 0;   perceived: x(t - lag), in N after multiplication with the fixture's stiffness K
//     without pauses:  x_d' = -L x(t - lag),  L = g K in 1/s
//     with pauses:     every period P a move of x_d by -c x(t - lag), minimum jerk, c without unit
//
// A person who moves and waits (Ferrell 1965) sees the outcome of a move before the next one if lag + move <= P. Then a hand that
// has come to rest follows X_{n+1} = (1 - c) X_n and is stable for c < 2, whatever the lag. A person who does not wait long
// enough sees a state that is d moves old, X_{n+1} = X_n - c X_{n-d}, d = ceil((lag + move) / P) - 1, stable for
// c < 2 sin(pi / (4 d + 2)) (Levin and May 1976). SI units. Meaningless input throws Error (usage): a hand as in
// perceptual_limit(), lags and periods that are not above zero.
#pragma once

#include "stability/delayed_loop.hpp"

namespace thimble {

struct PausedCorrection {
    double lag_s = 0;     // delay + device + reaction
    double period_s = 0;  // from one move to the next
    double move_s = 0;    // at most the period
};

// Of the error, per move; a hand that comes to rest within what is left of a period.
double paused_limit(const PausedCorrection& correction);

// Growth per second of the running loop let go from 1 mm, as measured (loop_measures.hpp): the hand stepped exactly, in steps of at
// most 1 ms that divide the lag.
double measured_perceptual_growth_per_s(const HeldMass& hand, double lag_s, double gain_per_s);
// The gain at which that turns positive, to `relative`.
double measured_perceptual_limit_per_s(const HeldMass& hand, double lag_s, double relative);

// The same with pauses: greatest c that dies out.
double measured_paused_limit(const HeldMass& hand, const PausedCorrection& correction, double relative);

}  // namespace thimble
