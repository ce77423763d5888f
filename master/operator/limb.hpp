// Handle, pinch grip and forearm as one physical system, two masses on one axis (structure: Speich et al. 2005).
//     handle   m_d x_d" = k_g (x_a - x_d) + b_g (x_a' - x_d') - b_d x_d' - F_f - F_dev       x_d = hand position
//     forearm  m_a x_a" = -k_g (x_a - x_d) - b_g (x_a' - x_d') - k_a (x_a - x_eq) - b_a (x_a' - v_cmd) + F_ff
//     b_g = 2 zeta_g sqrt(k_g m_d),  b_a = 2 zeta_a sqrt(k_a (m_a + m_d))
//     F_f = F_c z / z_d,  z' = x_d' - |x_d'| z / z_d         Dahl friction, |z| <= z_d
//     F_ff = F_c tanh(v_cmd / v_0) + b_d v_cmd               what the operator has learned of that friction
// z positive into the tissue; F_dev, the handle's force, positive pushes the hand out (towards -z).
// Semi-implicit Euler; F_dev, x_eq and v_cmd are held between steps.
#pragma once

#include <cassert>
#include <cmath>

#include "common/math/portable.hpp"
#include "common/time.hpp"
#include "master/operator/operator_parameters.hpp"

namespace thimble {

// tanh, without the call where it is 1 to within 4e-8 (the operator moves at 10 to 40 times the learned
// speed).
inline double learned_sign(double x) {
    constexpr double kSaturated = 8.8;
    if (x > kSaturated) return 1;
    if (x < -kSaturated) return -1;
    return portable::tanh(x);
}

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
    double stiffness_factor = 1;  // co-contraction and load: multiplies k_a and k_g; damping ratios stay
    double damping_factor = 1;    // load: multiplies b_a and b_g beyond that
};

class Limb {
  public:
    static constexpr Duration kStep = std::chrono::microseconds(100);

    Limb(const HandleMechanics& handle, const HandMechanics& hand, Duration step = kStep)
        : handle_(handle), hand_(hand), step_s_(to_seconds(step)), per_travel_(1 / handle.friction_travel_m) {
        assert(step > Duration::zero() && handle.moving_mass_kg > 0 && handle.friction_travel_m > 0);
        reset(hand.arm_stiffness_N_per_m, hand.grip_stiffness_N_per_m);
    }

    // Another person, at rest at z = 0.
    void reset(double arm_stiffness_N_per_m, double grip_stiffness_N_per_m) {
        arm_stiffness_N_per_m_ = arm_stiffness_N_per_m;
        grip_stiffness_N_per_m_ = grip_stiffness_N_per_m;
        state_ = {};
        command_ = {};
        drive_m_per_s_ = 0;
        stiffen(1, 1);
    }

    void command(const LimbCommand& command) {
        const bool stiffer = command.stiffness_factor != command_.stiffness_factor ||
                             command.damping_factor != command_.damping_factor;
        if (stiffer) stiffen(command.stiffness_factor, command.damping_factor);
        if (stiffer || command.velocity_m_per_s != command_.velocity_m_per_s) {
            const double v_cmd = command.velocity_m_per_s;
            const double feed_forward_N =
                handle_.friction_N * learned_sign(v_cmd / hand_.friction_learned_speed_m_per_s) +
                handle_.damping_Ns_per_m * v_cmd;
            drive_m_per_s_ = gains_.damping_arm * v_cmd + feed_forward_N * step_s_ / hand_.arm_mass_kg;
        }
        command_ = command;
    }

    void advance(unsigned steps, double force_handle_N) {
        // Everything in locals: the compiler then keeps the loop in registers.
        const Gains g = gains_;
        const double equilibrium_m = command_.equilibrium_m, drive = drive_m_per_s_, dt = step_s_;
        const double push = g.force_hand * force_handle_N, slide = dt * per_travel_;
        State s = state_;
        for (unsigned i = 0; i < steps; ++i) {
            const double stretch_m = s.arm_m - s.hand_m, stretch_m_per_s = s.arm_m_per_s - s.hand_m_per_s;
            // Friction last: its division is the longest wait of the loop.
            s.hand_m_per_s =
                (s.hand_m_per_s + (g.grip_hand * stretch_m + g.grip_damping_hand * stretch_m_per_s) -
                 (g.damping_hand * s.hand_m_per_s + push)) -
                g.friction_hand * s.bristle;
            s.arm_m_per_s += (drive - (g.grip_arm * stretch_m + g.grip_damping_arm * stretch_m_per_s)) -
                             g.spring_arm * (s.arm_m - equilibrium_m) - g.damping_arm * s.arm_m_per_s;
            s.hand_m += dt * s.hand_m_per_s;
            s.arm_m += dt * s.arm_m_per_s;
            // Implicit in z, so |z| <= z_d at any speed; an explicit step overshoots above 0.3 m/s.
            const double slid = slide * s.hand_m_per_s;
            // A hand that slides on leaves a full bristle as it is, to the last bit, and waits for no division.
            const bool full = slid > 0 ? s.bristle == 1 : s.bristle == -1;
            if (!full) s.bristle = (s.bristle + slid) / (1 + std::fabs(slid));
        }
        state_ = s;
    }

    double position_hand_m() const { return state_.hand_m; }
    double velocity_hand_m_per_s() const { return state_.hand_m_per_s; }
    double position_arm_m() const { return state_.arm_m; }
    double friction_N() const { return handle_.friction_N * state_.bristle; }
    // Kinetic and elastic, about the commanded equilibrium, the presliding of the friction included.
    double energy_J() const {
        const double factor = command_.stiffness_factor;
        const double stretch_m = state_.arm_m - state_.hand_m, away_m = state_.arm_m - command_.equilibrium_m;
        const double bristle_m = state_.bristle * handle_.friction_travel_m;
        return 0.5 * (handle_.moving_mass_kg * state_.hand_m_per_s * state_.hand_m_per_s +
                      hand_.arm_mass_kg * state_.arm_m_per_s * state_.arm_m_per_s +
                      factor * grip_stiffness_N_per_m_ * stretch_m * stretch_m +
                      factor * arm_stiffness_N_per_m_ * away_m * away_m +
                      handle_.friction_N * per_travel_ * bristle_m * bristle_m);
    }

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
    void stiffen(double factor, double damping) {
        const double k_a = arm_stiffness_N_per_m_ * factor, k_g = grip_stiffness_N_per_m_ * factor;
        const double m_d = handle_.moving_mass_kg, m_a = hand_.arm_mass_kg;
        const double b_g = damping * (2 * hand_.grip_damping_ratio * std::sqrt(k_g * m_d));
        const double b_a = damping * (2 * hand_.arm_damping_ratio * std::sqrt(k_a * (m_a + m_d)));
        const double per_hand = step_s_ / m_d, per_arm = step_s_ / m_a;
        gains_ = {.grip_hand = k_g * per_hand,
                  .grip_damping_hand = b_g * per_hand,
                  .damping_hand = handle_.damping_Ns_per_m * per_hand,
                  .friction_hand = handle_.friction_N * per_hand,
                  .force_hand = per_hand,
                  .grip_arm = k_g * per_arm,
                  .grip_damping_arm = b_g * per_arm,
                  .spring_arm = k_a * per_arm,
                  .damping_arm = b_a * per_arm};
    }

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
