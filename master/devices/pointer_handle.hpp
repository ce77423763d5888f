// A simulated handle that a person's pointer draws through a virtual coupling: no operator's limb, no motor. The person
// feels nothing in the hand but sees the needle give way, which is what HF can be with a mouse.
//     m_d x" = F_c - b_c x' - b_d x' - F_f - F_dev,   F_c = k_c (x_wanted - x) within +-coupling.force_limit_N, 0 if let go
// F_f, F_dev and signs as in limb.hpp; z positive into the tissue. The damper stands between handle and ground, not
// between handle and pointer: a pointer moves in steps of a screen's frame, and their derivative would be blows.
//
// Let go (not engaged, or no input for kLetGoAfter) is no spring and the damper alone. A spring to the last wanted place
// would push on without a hand, and with delay oscillate by itself; a handle without a spring can
// only lose energy. It rests where friction stops it, and the needle with it, commands going on.
//
// Time is a grid of 0.1 ms that starts with the trial; a call at `now` advances to the last grid point not after it.
// A wanted place holds from the grid point that had been reached when it arrived.
#pragma once

#include <algorithm>
#include <cmath>

#include "master/devices/software_handle.hpp"

namespace thimble {

class PointerHandle : public SoftwareHandle, public HandFollower {
  public:
    static constexpr Duration kLetGoAfter = std::chrono::milliseconds{100};

    explicit PointerHandle(const HandleSettings& settings) : SoftwareHandle(settings) {}

    // Starts at rest at z = 0, without a hand.
    void start_trial(SessionTime now, const OperatorTask& /*task*/) override {
        in_trial_ = true;
        reached_ = let_go_ = now;
        position_m_ = velocity_m_per_s_ = bristle_ = force_hand_N_ = 0;
    }

    HandFollower* follower() override { return this; }
    void follow(SessionTime now, const HandInput& input) override {
        advance(now);
        wanted_m_ = input.position_hand_m;
        let_go_ = input.engaged ? now + kLetGoAfter : now;
    }

    double position_hand_m() const override { return position_m_; }
    double velocity_hand_m_per_s() const { return velocity_m_per_s_; }

  private:
    // A stall longer than this is left out.
    static constexpr Duration kLongestStall = std::chrono::seconds(1);

    void advance(SessionTime now) override {
        if (!in_trial_) return;
        if (const Duration excess = now - reached_ - kLongestStall; excess > Duration::zero()) {
            reached_ += excess / Limb::kStep * Limb::kStep;
        }
        for (; now - reached_ >= Limb::kStep; reached_ += Limb::kStep) step();
    }

    // Semi-implicit Euler; Dahl friction implicit in its bristle, as in limb.hpp.
    void step() {
        const HandleMechanics& handle = settings_.mechanics;
        const double dt = to_seconds(Limb::kStep);
        const double damping_Ns_per_m = handle.damping_Ns_per_m + settings_.coupling.damping_Ns_per_m;
        const double force_N =
            pull_N() - damping_Ns_per_m * velocity_m_per_s_ - handle.friction_N * bristle_ - force_hand_N_;
        velocity_m_per_s_ += dt / handle.moving_mass_kg * force_N;
        position_m_ += dt * velocity_m_per_s_;
        const double slid = dt / handle.friction_travel_m * velocity_m_per_s_;
        bristle_ = (bristle_ + slid) / (1 + std::fabs(slid));
    }

    // A pointer may jump across the screen.
    double pull_N() const {
        if (reached_ >= let_go_) return 0;
        return std::clamp(settings_.coupling.stiffness_N_per_m * (wanted_m_ - position_m_),
                          -settings_.coupling.force_limit_N, settings_.coupling.force_limit_N);
    }

    bool in_trial_ = false;
    SessionTime reached_{};  // grid point
    double position_m_ = 0, velocity_m_per_s_ = 0;
    double bristle_ = 0;  // of the friction, in [-1, 1]
    double wanted_m_ = 0;
    SessionTime let_go_{};  // the spring holds before this
};

}  // namespace thimble
