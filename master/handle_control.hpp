// A delay compensator in the master's loop: what arrives becomes a request, and at each sample of the handle the force that
// the compensator makes of it, held until the next sample. F positive pushes the hand out (-z). No clock, no device.
//
// Where an answer arrives between two samples its force waits for the next one, up to a sample period: what these compensators
// promise is counted in held forces. An answer that arrives in the sample's own instant still counts for it. A controller that
// acts at once (THIMBLE_AT_ONCE) is asked by MasterNode for each answer instead.
#pragma once

#include <optional>

#include "common/control/controller_ends.hpp"
#include "master/devices/haptic_device.hpp"

namespace thimble {

class HandleControl {
  public:
    // Throws Error (usage) if the settings make no controller.
    HandleControl(const ControlSettings& settings, const HandleControlScale& scale);

    // network_delay: there and back, of a link that is to be expected.
    void start(bool kinesthetic, Duration network_delay);
    // The network takes so long now, there and back.
    void network_changed(Duration network_delay);
    void end() { present_ = false; }

    // A controller is in the loop of this trial.
    bool present() const { return present_; }
    // It works at samples, not at once.
    bool active() const { return present_ && !end_->has(THIMBLE_AT_ONCE); }
    // Messages carry what its two ends tell each other.
    bool waves() const { return present_ && end_->has(THIMBLE_BOTH_ENDS); }

    // All of the following only while present().
    void sample(SessionTime now, const HandleSample& handle, double velocity_hand_m_per_s = 0);
    void take(const ForceFeedback& feedback, Duration age = {});
    void take(const WaveBurst& waves);
    // Between two forces: the next force_N() is computed from this one, which the network did not bring.
    void predict(const ForceFeedback& feedback, Duration age);
    // After a long silence, or while the needle is held: no wanted force and no known fixture. Waves that do not come are
    // zeros by themselves, which brakes the hand.
    void forget();
    double force_N();

    const WaveBurst& burst() const { return burst_; }  // to go with the sample's command; only if waves()
    const HandleEnd* end_of_plugin() const { return end_ && !end_->file().empty() ? &*end_ : nullptr; }

  private:
    HandleControlScale scale_;
    bool present_ = false;
    std::optional<HandleEnd> end_;
    WaveBurst burst_{};
};

}  // namespace thimble
