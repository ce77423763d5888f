// A delay compensator in the master's loop: what arrives becomes a request, and at each sample of the handle the force that
// the compensator makes of it, held until the next sample. (A share for the hand needs no samples: MasterNode.) F positive pushes
// the hand out (-z). No clock, no device.
//
// Where an answer arrives between two samples its force waits for the next one, up to a sample period: what these compensators
// promise is counted in held forces. An answer that arrives in the sample's own instant still counts for it.
#pragma once

#include <memory>
#include <optional>

#include "common/control/control_settings.hpp"
#include "common/control/port_compensator.hpp"
#include "common/control/two_port_passivity.hpp"
#include "common/control/wave_variables.hpp"
#include "common/messages.hpp"
#include "common/shared_values.hpp"
#include "master/devices/haptic_device.hpp"

namespace thimble {

struct HandleControlScale {
    double position_scale = kPositionScale;  // needle = scale x hand
    double force_scale = 1;
    double force_limit_N = kHandleFullScale_N;
    Duration sample_period = std::chrono::milliseconds{1};
};

class HandleControl {
  public:
    // Throws Error (usage) if the settings make no controller.
    HandleControl(const ControlSettings& settings, const HandleControlScale& scale);

    // network_delay: there and back, of a link that is to be expected.
    void start(bool kinesthetic, Duration network_delay);
    // The network takes so long now, there and back. Waves wait for it from now on, or, where it is shorter, once those under
    // way have come.
    void network_changed(Duration network_delay);
    void end() { active_ = false; }

    // A compensator that works at samples is in the loop of this trial.
    bool active() const { return active_; }
    // Messages carry waves, or the energies of two-port passivity.
    bool waves() const { return active_ && (waves_ || two_port_); }

    void sample(SessionTime now, const HandleSample& handle);
    void take(const ForceFeedback& feedback);
    void take(const WaveBurst& waves);
    // After a long silence, or while the needle is held: no wanted force and no known fixture. Waves that do not come are
    // zeros by themselves, which brakes the hand.
    void forget();
    double force_N();

    const WaveBurst& burst() const { return burst_; }  // to go with the sample's command; only if waves()

  private:
    struct Waves {
        WaveMaster master;
        WaveSender sender;
        WaveReceiver receiver;
        double in_root_W = 0;
    };
    static std::unique_ptr<Waves> make_waves(const ControlSettings& settings, double period_s);
    std::uint32_t play_out_samples(Duration network_delay) const;

    ControlSettings settings_;
    HandleControlScale scale_;
    bool active_ = false;
    std::unique_ptr<PortCompensator> port_;  // of the compensators at one port, else null
    LocalFixture local_;
    std::unique_ptr<Waves> waves_;           // with kWave
    std::optional<TwoPortMaster> two_port_;  // with kTwoPort
    WaveBurst burst_{};
    double energy_heard_J_ = 0;
    SessionTime sampled_{};
    bool sampled_before_ = false;
    double position_hand_m_ = 0;
    double asked_N_ = 0;  // of the port's compensators: the whole force; of the local fixture: tissue
};

}  // namespace thimble
