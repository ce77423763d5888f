// An omega.3-like handle with the virtual operator's hand on it: one physical system, integrated together.
//
// Its time is a grid of 0.1 ms (plant) and 1 ms (brain) that starts with the trial. A call at `now` first advances to
// the last grid point not after `now`. So the times of the calls do not matter: reads at 0.37 ms and 1 ms give the
// same bits as a read at 1 ms alone. A command or percept at the instant of a brain tick counts in that tick.
#pragma once

#include <algorithm>
#include <optional>

#include "master/devices/software_handle.hpp"
#include "master/operator/virtual_operator.hpp"

namespace thimble {

inline constexpr unsigned kSubsteps = kBrainTick / Limb::kStep;

class SimulatedHandle final : public SoftwareHandle {
  public:
    SimulatedHandle(const HandleSettings& settings, const OperatorParameters& parameters)
        : SoftwareHandle(settings), parameters_(parameters), limb_(settings.mechanics, parameters.hand) {}

    void start_trial(SessionTime now, const OperatorTask& task) override {
        operator_.emplace(parameters_, task);
        limb_.reset(operator_->subject().arm_stiffness_N_per_m, operator_->subject().grip_stiffness_N_per_m);
        percept_ = {};
        reached_ = now;
        substep_ = 0;
        force_hand_N_ = 0;
    }

    // Each percept replaces the last one whole; touch and beep are remembered.
    void perceive(SessionTime now, const Percept& percept) override {
        advance(now);
        const bool touching = percept_.touching_shown, beep = percept_.beep;
        percept_ = percept;
        percept_.touching_shown |= touching;
        percept_.beep |= beep;
    }

    bool finished() const override { return operator_ && operator_->finished(); }

    double position_hand_m() const override { return limb_.position_hand_m(); }

  private:
    static constexpr Duration kLongestGap = std::chrono::seconds(1);  // what is longer is skipped

    void advance(SessionTime now) override {
        if (!operator_) return;  // no hand holds the handle: it lies at z = 0
        if (const Duration excess = now - reached_ - kLongestGap; excess > Duration::zero()) {
            reached_ += excess / kBrainTick * kBrainTick;
        }
        while (now - reached_ >= Limb::kStep) {
            if (substep_ == 0) {
                limb_.command(operator_->tick(force_hand_N_, percept_, limb_.position_arm_m()));
            }
            const auto due = static_cast<unsigned>((now - reached_) / Limb::kStep);
            const unsigned steps = std::min(due, kSubsteps - substep_);
            limb_.advance(steps, force_hand_N_);
            operator_->prepare();
            reached_ += steps * Limb::kStep;
            substep_ = (substep_ + steps) % kSubsteps;
        }
    }

    OperatorParameters parameters_;
    Limb limb_;
    std::optional<VirtualOperator> operator_;
    Percept percept_;
    SessionTime reached_{};  // grid point
    unsigned substep_ = 0;   // of the millisecond under way
};

}  // namespace thimble
