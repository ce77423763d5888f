#include "master/devices/simulated_handle.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr unsigned kSubsteps = kBrainTick / Limb::kStep;
constexpr Duration kLongestGap = std::chrono::seconds(1);

}  // namespace

SimulatedHandle::SimulatedHandle(const HandleSettings& settings, const OperatorParameters& parameters)
    : SoftwareHandle(settings), parameters_(parameters), limb_(settings.mechanics, parameters.hand) {}

void SimulatedHandle::start_trial(SessionTime now, const OperatorTask& task) {
    operator_.emplace(parameters_, task);
    limb_.reset(operator_->subject().arm_stiffness_N_per_m, operator_->subject().grip_stiffness_N_per_m);
    percept_ = {};
    reached_ = now;
    substep_ = 0;
    force_hand_N_ = 0;
}

void SimulatedHandle::perceive(SessionTime now, const Percept& percept) {
    advance(now);
    const bool touching = percept_.touching_shown, beep = percept_.beep;
    percept_ = percept;
    percept_.touching_shown |= touching;
    percept_.beep |= beep;
}

bool SimulatedHandle::finished() const { return operator_ && operator_->finished(); }

void SimulatedHandle::advance(SessionTime now) {
    if (!operator_) return;  // no hand holds the handle: it lies at z = 0
    if (const Duration excess = now - reached_ - kLongestGap; excess > Duration::zero()) {
        const auto skipped = excess / kBrainTick;
        reached_ += skipped * kBrainTick;
        skipped_ms_ += static_cast<std::uint64_t>(skipped);
    }
    while (now - reached_ >= Limb::kStep) {
        if (substep_ == 0) {
            limb_.command(operator_->tick(force_hand_N_, percept_, limb_.position_arm_m()));
        }
        const auto due = static_cast<unsigned>((now - reached_) / Limb::kStep);
        const unsigned steps = std::min(due, kSubsteps - substep_);
        limb_.advance(steps, force_hand_N_);
        reached_ += steps * Limb::kStep;
        substep_ = (substep_ + steps) % kSubsteps;
    }
}

}  // namespace thimble
