// The last stage before the fingertips: the rules of ForceGuard, with the limits 0 and `limit_N`. A guard that has tripped keeps
// the cables slack until clear().
#pragma once

#include <string_view>

#include "common/force_guard.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

class GuardedActuator final : public FingertipActuator {
  public:
    // `device` outlives the guard.
    GuardedActuator(double limit_N, FingertipActuator& device)
        : rules_({0, limit_N, 0, {}}, "the fingertip device"), device_(&device) {}

    // A trial begins: not tripped.
    void clear(SessionTime now) { rules_.clear(now); }
    bool tripped() const { return rules_.tripped(); }
    std::string_view text() const { return rules_.text(); }

    void command(SessionTime now, Finger finger, double force_N) override {
        const double allowed_N = rules_.pass(now, force_N);
        if (tripped()) return device_->release(now);
        device_->command(now, finger, allowed_N);
    }
    FingertipForce output(SessionTime now) override { return device_->output(now); }
    void release(SessionTime now) override { device_->release(now); }
    void use_hand(SessionTime now, Hand hand) override { device_->use_hand(now, hand); }
    void tick(SessionTime now) override { device_->tick(now); }
    SessionTime next_wakeup() const override { return device_->next_wakeup(); }
    std::string_view fault() const override { return device_->fault(); }

  private:
    ForceGuard rules_;
    FingertipActuator* device_;
};

}  // namespace thimble
