#include "master/devices/pointer_handle.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

// A stall longer than this is left out.
constexpr Duration kLongestStall = std::chrono::seconds(1);

}  // namespace

void PointerHandle::start_trial(SessionTime now, const OperatorTask& /*task*/) {
    in_trial_ = true;
    reached_ = let_go_ = now;
    position_m_ = velocity_m_per_s_ = bristle_ = force_hand_N_ = 0;
}

void PointerHandle::follow(SessionTime now, const HandInput& input) {
    advance(now);
    wanted_m_ = input.position_hand_m;
    let_go_ = input.engaged ? now + kLetGoAfter : now;
}

void PointerHandle::advance(SessionTime now) {
    if (!in_trial_) return;
    if (const Duration excess = now - reached_ - kLongestStall; excess > Duration::zero()) {
        reached_ += excess / Limb::kStep * Limb::kStep;
    }
    for (; now - reached_ >= Limb::kStep; reached_ += Limb::kStep) step();
}

// No stronger than the device it pulls at: a pointer may jump across the screen.
double PointerHandle::pull_N() const {
    if (reached_ >= let_go_) return 0;
    return std::clamp(settings_.coupling.stiffness_N_per_m * (wanted_m_ - position_m_),
                      -settings_.force_limit_N, settings_.force_limit_N);
}

// Semi-implicit Euler; Dahl friction implicit in its bristle, as in limb.cpp.
void PointerHandle::step() {
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

}  // namespace thimble
