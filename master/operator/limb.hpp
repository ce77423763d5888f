// Handle, pinch grip and forearm as one physical system, two masses on one axis (structure: Speich et al. 2005).
//     handle   m_d x_d" = k_g (x_a - x_d) + b_g (x_a' - x_d') - b_d x_d' - F_f - F_dev       x_d = hand position
//     forearm  m_a x_a" = -k_g (x_a - x_d) - b_g (x_a' - x_d') - k_a (x_a - x_eq) - b_a (x_a' - v_cmd) + F_ff
//     b_g = 2 zeta_g sqrt(k_g m_d),  b_a = 2 zeta_a sqrt(k_a (m_a + m_d))
//     F_f = F_c z / z_d,  z' = x_d' - |x_d'| z / z_d         Dahl friction, |z| <= z_d
//     F_ff = F_c tanh(v_cmd / v_0) + b_d v_cmd               what the operator has learned of that friction
// z positive into the tissue; F_dev, the handle's force, positive pushes the hand out (towards -z).
// Semi-implicit Euler; F_dev, x_eq and v_cmd are held between steps.
#pragma once

#include "common/time.hpp"
#include "master/operator/operator_parameters.hpp"

namespace thimble {

// Moving part of the handle, as felt along z.
struct HandleMechanics {
    double moving_mass_kg = 0.25;   // [A] 0.15-0.4
    double damping_Ns_per_m = 1.0;  // [A]
    double friction_N = 0.65;  // [A] handle and clamps, 0-2; delayed contact oscillates only below about 1 N
    double friction_travel_m = 3e-5;  // [A] z_d, presliding
};

struct LimbCommand {
    double equilibrium_m = 0;     // x_eq: where the hand would come to rest, noise included
    double velocity_m_per_s = 0;  // v_cmd: intended
    double stiffness_factor = 1;  // co-contraction: multiplies k_a and k_g; damping ratios stay
};

class Limb {
  public:
    static constexpr Duration kStep = std::chrono::microseconds(100);

    Limb(const HandleMechanics& handle, const HandMechanics& hand, Duration step = kStep);

    // Another person, at rest at z = 0.
    void reset(double arm_stiffness_N_per_m, double grip_stiffness_N_per_m);
    void command(const LimbCommand& command);
    void advance(unsigned steps, double force_handle_N);

    double position_hand_m() const { return state_.hand_m; }
    double velocity_hand_m_per_s() const { return state_.hand_m_per_s; }
    double position_arm_m() const { return state_.arm_m; }
    double friction_N() const { return handle_.friction_N * state_.bristle; }
    // Kinetic and elastic, about the commanded equilibrium, the presliding of the friction included.
    double energy_J() const;

  private:
    struct State {
        double hand_m = 0, hand_m_per_s = 0;
        double arm_m = 0, arm_m_per_s = 0;
        double bristle = 0;  // z / z_d, in [-1, 1]
    };
    // Velocity gained per step and per unit of each cause.
    struct Gains {
        double grip_hand, grip_damping_hand, damping_hand, friction_hand, force_hand;
        double grip_arm, grip_damping_arm, spring_arm, damping_arm;
    };
    void stiffen(double factor);

    HandleMechanics handle_;
    HandMechanics hand_;
    double step_s_;
    double per_travel_;                                              // 1 / z_d
    double arm_stiffness_N_per_m_ = 0, grip_stiffness_N_per_m_ = 0;  // relaxed
    LimbCommand command_;
    double drive_m_per_s_ = 0;  // velocity per step that v_cmd and its feed-forward give the arm
    Gains gains_{};
    State state_;
};

}  // namespace thimble
