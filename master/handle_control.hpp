// A delay compensator in the master's loop: what arrives becomes a request, and at each sample of the handle the force that
// the compensator makes of it, held until the next sample. F positive pushes the hand out (-z). No clock, no device.
//
// Where an answer arrives between two samples its force waits for the next one, up to a sample period: what these compensators
// promise is counted in held forces. An answer that arrives in the sample's own instant still counts for it. A controller that
// acts at once (THIMBLE_AT_ONCE) is asked by MasterNode for each answer instead.
#pragma once

#include <algorithm>
#include <optional>

#include "common/control/controller_ends.hpp"
#include "master/devices/haptic_device.hpp"

namespace thimble {

class HandleControl {
  public:
    // Throws Error (usage) if the settings make no controller.
    HandleControl(const ControlSettings& settings, const HandleControlScale& scale) : scale_(scale) {
        if (settings.compensator != Compensator::kNone) end_.emplace(settings, scale);
    }

    // network_delay: there and back, of a link that is to be expected.
    void start(bool kinesthetic, Duration network_delay) {
        present_ = kinesthetic && end_;
        burst_ = {};
        if (present_) end_->start(network_delay);
    }
    // The network delay has changed; there and back.
    void network_changed(Duration network_delay) {
        if (present_) end_->network_changed(network_delay);
    }
    void end() { present_ = false; }

    // A controller is in the loop of this trial.
    bool present() const { return present_; }
    // True for a controller that computes at samples, not for each answer at once.
    bool active() const { return present_ && !end_->has(THIMBLE_AT_ONCE); }
    // True if the two ends exchange values in the messages.
    bool waves() const { return present_ && end_->has(THIMBLE_BOTH_ENDS); }

    // All of the following only while present().
    void sample(SessionTime now, const HandleSample& handle, double velocity_hand_m_per_s = 0) {
        burst_ = end_->sample(now, handle.position_hand_m, velocity_hand_m_per_s, handle.force_hand_N);
    }
    void take(const ForceFeedback& feedback, Duration age = {}) {
        if (feedback.needle_held) return forget();
        end_->receive(feedback_of(feedback, scale_, to_seconds(age)));
    }
    void take(const WaveBurst& waves) { end_->receive(waves); }
    // Between two forces: force_N() uses this predicted one, which did not come over the network.
    void predict(const ForceFeedback& feedback, Duration age) {
        end_->predict(feedback_of(feedback, scale_, to_seconds(age)));
    }
    // After a long silence, or while the needle is held: no wanted force and no known fixture. Missing waves count as
    // zero, which brakes the hand.
    void forget() { end_->forget(); }
    // waited: since the newest force came.
    double force_N(Duration waited = {}) {
        return std::clamp(end_->force_N(waited), -scale_.force_limit_N, scale_.force_limit_N);
    }

    const WaveBurst& burst() const { return burst_; }  // to go with the sample's command; only if waves()
    const HandleEnd* end_of_plugin() const { return end_ && !end_->file().empty() ? &*end_ : nullptr; }

  private:
    HandleControlScale scale_;
    bool present_ = false;
    std::optional<HandleEnd> end_;
    WaveBurst burst_{};
};

}  // namespace thimble
