// Hands that hold a handle, and how much delay their force loop bears before it oscillates.
//
// In contact and below saturation the loop is D(s) x = -K e^(-sT) x about its equilibrium: a fixture of stiffness K at the
// handle, felt T later. It is stable for T = 0 (every part is passive) and stays so until the first T at which a root reaches
// the imaginary axis: |D(jw)| = K and w T = -arg(-D(jw)). (Walton and Marshall 1987, "direct method"; Cooke and van den
// Driessche 1986.) A hold of period h adds h/2 to T, within 1 us at 1 kHz. Dry friction is left out: it keeps small
// oscillations away and lets a large one live on. SI units. Every function throws Error (usage) for what is no hand or no loop:
// a mass that is not positive, anything negative or not finite, a loop stiffness of zero.
#pragma once

#include <array>

namespace thimble {

// m x" + b x' + k x, all at the handle. Masses above zero, damping and stiffness zero or more.
struct HeldMass {
    double mass_kg = 0;
    double damping_Ns_per_m = 0;
    double stiffness_N_per_m = 0;
};

// Handle, grip and forearm (master/operator/limb.hpp), seen at the handle:
//     D(s) = m_d s^2 + b_d s + Zg Zh / (Zg + Zh),  Zg = k_g + b_g s,  Zh = m_a s^2 + b_a s + k_a
struct HeldHandle {
    double handle_mass_kg = 0;
    double handle_damping_Ns_per_m = 0;
    double grip_stiffness_N_per_m = 0;
    double grip_damping_Ns_per_m = 0;
    double arm_mass_kg = 0;
    double arm_damping_Ns_per_m = 0;
    double arm_stiffness_N_per_m = 0;
};

// Where a root reaches the imaginary axis first. Both infinite and zero if no delay makes the loop unstable.
struct CriticalPoint {
    double delay_s = 0;
    double frequency_rad_per_s = 0;
};

// Closed form for the mass; for the handle, w^2 is a root of a polynomial of degree four. To the last digits of a double.
CriticalPoint critical_point(const HeldMass& held, double loop_stiffness_N_per_m);
CriticalPoint critical_point(const HeldHandle& held, double loop_stiffness_N_per_m);
double critical_delay_s(const HeldMass& held, double loop_stiffness_N_per_m);
double critical_delay_s(const HeldHandle& held, double loop_stiffness_N_per_m);

// Five hands that the stability study looks at, from a light pinch to a power grip (sources: docs/stability.md).

struct TypicalHand {
    const char* name = "";  // a letter, then what it is
    HeldMass hand;
};
inline constexpr std::array<TypicalHand, 5> kTypicalHands{{{"A light pinch", {0.15, 3, 300}},
                                                           {"B pinch", {0.35, 6, 400}},
                                                           {"C measured arm", {0.55, 6.45, 135}},
                                                           {"D firm grip", {1, 20, 500}},
                                                           {"E power grip", {2, 40, 1000}}}};

}  // namespace thimble
