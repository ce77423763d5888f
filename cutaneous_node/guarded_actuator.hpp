// The last stage before the fingertips: whoever asks, and however wrong, no finger is pressed harder than `limit_N`, and a force
// that is no number lets go and trips. It knows the request and the device, no message and no network. It stays tripped until
// clear(), with the cables slack.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

class GuardedActuator final : public FingertipActuator {
  public:
    // `device` outlives the guard.
    GuardedActuator(double limit_N, FingertipActuator& device) : limit_N_(limit_N), device_(&device) {}

    void clear() { tripped_ = false; }
    bool tripped() const { return tripped_; }
    static constexpr std::string_view kWords = "a force was asked of the fingertip device that is no number";

    void command(SessionTime now, Finger finger, double force_N) override {
        if (!std::isfinite(force_N)) tripped_ = true;
        if (tripped_) return device_->release(now);
        device_->command(now, finger, std::clamp(force_N, 0.0, limit_N_));
    }
    FingertipForce output(SessionTime now) override { return device_->output(now); }
    void release(SessionTime now) override { device_->release(now); }
    void use_hand(SessionTime now, Hand hand) override { device_->use_hand(now, hand); }
    void tick(SessionTime now) override { device_->tick(now); }
    SessionTime next_wakeup() const override { return device_->next_wakeup(); }
    std::string_view fault() const override { return device_->fault(); }

  private:
    double limit_N_;
    FingertipActuator* device_;
    bool tripped_ = false;
};

}  // namespace thimble
