// How much delay the force loop of a held handle bears before it oscillates.
//
// In contact and below saturation the loop is D(s) x = -K e^(-sT) x about its equilibrium: a fixture of stiffness K at the
// handle, felt T later. It is stable for T = 0 (every part is passive) and stays so until the first T at which a root reaches
// the imaginary axis: |D(jw)| = K and w T = -arg(-D(jw)). (Walton and Marshall 1987, "direct method"; Cooke and van den
// Driessche 1986.) A hold of period h adds h/2 to T, within 1 us at 1 kHz. Dry friction is left out: it keeps small
// oscillations away and lets a large one live on. SI units.
#pragma once

namespace thimble {

// m x" + b x' + k x, closed form: T = theta / w, theta = -arg(-D(jw)) in [0, 2 pi), at the greater root w of |D(jw)| = K. Infinite if no delay makes
// the loop unstable.
struct HeldMass {
    double mass_kg = 0;
    double damping_Ns_per_m = 0;
    double stiffness_N_per_m = 0;
};
double critical_delay_s(const HeldMass& held, double loop_stiffness_N_per_m);

// Handle, grip and forearm (master/operator/limb.hpp), seen at the handle:
//     D(s) = m_d s^2 + b_d s + Zg Zh / (Zg + Zh),  Zg = k_g + b_g s,  Zh = m_a s^2 + b_a s + k_a
// Roots of |D(jw)| = K are found on a grid and by bisection.
struct HeldHandle {
    double handle_mass_kg = 0;
    double handle_damping_Ns_per_m = 0;
    double grip_stiffness_N_per_m = 0;
    double grip_damping_Ns_per_m = 0;
    double arm_mass_kg = 0;
    double arm_damping_Ns_per_m = 0;
    double arm_stiffness_N_per_m = 0;
};
double critical_delay_s(const HeldHandle& held, double loop_stiffness_N_per_m);

}  // namespace thimble
