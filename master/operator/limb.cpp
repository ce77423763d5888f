#include "master/operator/limb.hpp"

#include <cassert>
#include <cmath>

namespace thimble {
namespace {

// tanh, without the call where it is 1 to within 4e-8 (the operator moves at 10 to 40 times the learned
// speed).
double learned_sign(double x) {
    constexpr double kSaturated = 8.8;
    if (x > kSaturated) return 1;
    if (x < -kSaturated) return -1;
    return std::tanh(x);
}

}  // namespace

Limb::Limb(const HandleMechanics& handle, const HandMechanics& hand, Duration step)
    : handle_(handle), hand_(hand), step_s_(to_seconds(step)), per_travel_(1 / handle.friction_travel_m) {
    assert(step > Duration::zero() && handle.moving_mass_kg > 0 && handle.friction_travel_m > 0);
    reset(hand.arm_stiffness_N_per_m, hand.grip_stiffness_N_per_m);
}

void Limb::reset(double arm_stiffness_N_per_m, double grip_stiffness_N_per_m) {
    arm_stiffness_N_per_m_ = arm_stiffness_N_per_m;
    grip_stiffness_N_per_m_ = grip_stiffness_N_per_m;
    state_ = {};
    command_ = {};
    drive_m_per_s_ = 0;
    stiffen(1);
}

void Limb::stiffen(double factor) {
    const double k_a = arm_stiffness_N_per_m_ * factor, k_g = grip_stiffness_N_per_m_ * factor;
    const double m_d = handle_.moving_mass_kg, m_a = hand_.arm_mass_kg;
    const double b_g = 2 * hand_.grip_damping_ratio * std::sqrt(k_g * m_d);
    const double b_a = 2 * hand_.arm_damping_ratio * std::sqrt(k_a * (m_a + m_d));
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

void Limb::command(const LimbCommand& command) {
    const bool stiffer = command.stiffness_factor != command_.stiffness_factor;
    if (stiffer) stiffen(command.stiffness_factor);
    if (stiffer || command.velocity_m_per_s != command_.velocity_m_per_s) {
        const double v_cmd = command.velocity_m_per_s;
        const double feed_forward_N =
            handle_.friction_N * learned_sign(v_cmd / hand_.friction_learned_speed_m_per_s) +
            handle_.damping_Ns_per_m * v_cmd;
        drive_m_per_s_ = gains_.damping_arm * v_cmd + feed_forward_N * step_s_ / hand_.arm_mass_kg;
    }
    command_ = command;
}

void Limb::advance(unsigned steps, double force_handle_N) {
    // Everything in locals: the compiler then keeps the loop in registers.
    const Gains g = gains_;
    const double equilibrium_m = command_.equilibrium_m, drive = drive_m_per_s_, dt = step_s_;
    const double push = g.force_hand * force_handle_N, slide = dt * per_travel_;
    State s = state_;
    for (unsigned i = 0; i < steps; ++i) {
        const double stretch_m = s.arm_m - s.hand_m, stretch_m_per_s = s.arm_m_per_s - s.hand_m_per_s;
        // Friction last: its division is the longest wait of the loop.
        s.hand_m_per_s = (s.hand_m_per_s + (g.grip_hand * stretch_m + g.grip_damping_hand * stretch_m_per_s) -
                          (g.damping_hand * s.hand_m_per_s + push)) -
                         g.friction_hand * s.bristle;
        s.arm_m_per_s += (drive - (g.grip_arm * stretch_m + g.grip_damping_arm * stretch_m_per_s)) -
                         g.spring_arm * (s.arm_m - equilibrium_m) - g.damping_arm * s.arm_m_per_s;
        s.hand_m += dt * s.hand_m_per_s;
        s.arm_m += dt * s.arm_m_per_s;
        // Implicit in z, so |z| <= z_d at any speed; an explicit step overshoots above 0.3 m/s.
        const double slid = slide * s.hand_m_per_s;
        s.bristle = (s.bristle + slid) / (1 + std::fabs(slid));
    }
    state_ = s;
}

double Limb::energy_J() const {
    const double factor = command_.stiffness_factor;
    const double stretch_m = state_.arm_m - state_.hand_m, away_m = state_.arm_m - command_.equilibrium_m;
    const double bristle_m = state_.bristle * handle_.friction_travel_m;
    return 0.5 * (handle_.moving_mass_kg * state_.hand_m_per_s * state_.hand_m_per_s +
                  hand_.arm_mass_kg * state_.arm_m_per_s * state_.arm_m_per_s +
                  factor * grip_stiffness_N_per_m_ * stretch_m * stretch_m +
                  factor * arm_stiffness_N_per_m_ * away_m * away_m +
                  handle_.friction_N * per_travel_ * bristle_m * bristle_m);
}

}  // namespace thimble
