// The final oscillation of an unstable loop. It stops growing because a fixture pushes one way only and the handle's force is limited.
//
//     force(t) = clip(K p(t - T), 0, F_s),  p = position beyond the wall;  m p" + b p' + k p = F_0 - force
//
// F_0 is the force with which the hand would press at the wall: k (x_d - x_wall). Two predictors:
//  - describing function (first harmonic, with the mean): the frequency is that of the critical stiffness at the same delay, the
//    amplitude that at which the equivalent gain has fallen to it. Gelb and Vander Velde 1968, dual-input describing functions.
//  - relay orbit: the force as a rectangle, switched where p passes half of the linear strip p_s = F_s / K; exact for p_s << A.
// Use the relay where the describing function says A > 4 p_s (about 1 % then), else the describing function (about 10 %, for F_0 near
// F_s / 2). Light hands at delays of several periods can settle on orbits with several extrema; neither predicts those.
#pragma once

#include <optional>

#include "stability/delayed_loop.hpp"

namespace thimble {

struct PressedLoop {
    HeldMass hand;                 // with a spring: without one nothing holds it at the wall
    double stiffness_N_per_m = 0;  // K
    double delay_s = 0;            // T, all of it; add half a step for a sampled loop
    double force_limit_N = 0;      // F_s
    double press_N = 0;            // F_0, any sign
};

struct LimitCycle {
    double frequency_rad_per_s = 0;
    double amplitude_m = 0;  // at the handle, half of what it travels
    double mean_m = 0;       // describing function: mean of p; relay orbit: middle of p's range
    double lowest_m = 0;     // least p: below zero contact is lost
    double highest_m = 0;
    double duty = 0;  // relay orbit: part of the period for which the force pushes
};

// None if no oscillation sustains itself. The larger, stable one of two.
std::optional<LimitCycle> describing_function_cycle(const PressedLoop& loop);
// Starts from `guess`; nothing if there is no orbit with two switches close to it.
std::optional<LimitCycle> relay_orbit(const PressedLoop& loop, const LimitCycle& guess);

enum class CyclePredictor : unsigned char { kDescribingFunction, kRelayOrbit };

struct PressForecast {
    double rest_m = 0;            // p of the equilibrium
    bool rest_is_stable = false;  // small disturbances die out
    bool pushed_through =
        false;  // F_0 > F_s (1 + k/K): the hand overcomes the handle, and at that rest no delay matters
    std::optional<LimitCycle> cycle;
    CyclePredictor predictor = CyclePredictor::kDescribingFunction;
};
PressForecast forecast_press(const PressedLoop& loop);

// Push-through and limit cycle exist side by side up to a press F_0fold, where the cycle ends: above it the only rest is deep behind
// the wall, at (F_0 - F_s) / k. Never below F_s (1 + k/K), where that rest begins. By the relay orbit, followed from half of the
// force limit upwards, where the describing function's is wider than four strips, else by the describing function: 0.5 N about.
// `press_N` is not read. Nothing if there is no cycle at half of the limit, infinite if it goes on to 100 times that press.
std::optional<double> press_fold_N(const PressedLoop& loop);

// The least damping that makes the loop stable at this delay, and the frequency there: the greatest K sin(wT) / w of all w with
// m w^2 - k = K cos(wT). Throws Error (usage) for more than 1e6 rad of delay: all of them are looked through.
struct NeededDamping {
    double damping_Ns_per_m = 0;
    double frequency_rad_per_s = 0;
};
NeededDamping needed_damping(const DelayedLoop& loop, double delay_s);

// Dry friction keeps oscillations below this amplitude from growing: A = 4 f_c / (pi w (b_c - b)), b_c the needed damping.
// Infinite where the loop is stable anyway.
double friction_threshold_m(const DelayedLoop& loop, double delay_s, double friction_N);

// An encoder step D at rest switches the force by K D. Without friction of K D / 2 that keeps up an oscillation whose amplitude is
// that of a relay of this size, 2 K D / (pi K*): about one step. Zero where friction holds it, or
// where K* is infinite; infinite where the loop is unstable anyway.
double encoder_chatter_m(double stiffness_N_per_m, double critical_stiffness_N_per_m, double encoder_step_m,
                         double friction_N);

}  // namespace thimble
