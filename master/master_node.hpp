// The master's logic: encoder reading in, needle command out; force feedback in, force at the handle out.
//
// The order inside a sample is fixed, because it decides the zero-delay verdict by a factor of three: a delay of d samples needs
// b >= K h (2d + 1) / 2 of hand damping (docs/model.md). The handle is read, and the command leaves at once. The force is given
// to the handle the moment the answer arrives, not at the next sample. Without network delay the force that acts from sample k
// on belongs to the position of sample k: d = 0.
#pragma once

#include <optional>

#include "common/config.hpp"
#include "common/control/control_settings.hpp"
#include "common/force_age.hpp"
#include "common/messages.hpp"
#include "common/reduction/force_codec.hpp"
#include "common/shared_values.hpp"
#include "common/stale_policy.hpp"
#include "common/velocity_estimator.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/guarded_handle.hpp"
#include "master/handle_control.hpp"

namespace thimble {

struct MasterSettings {
    double position_scale = kPositionScale;     // needle = scale x hand
    double force_scale = 1;                     // handle force = scale x needle force
    double force_limit_N = kHandleFullScale_N;  // at the handle, before the device's own limit
    Duration sample_period = std::chrono::milliseconds{1};
    StalePolicy stale{StaleMode::kRamp};  // of the handle's force, without feedback
    // A force that is older by stale.after counts as no feedback. The longest delay of needle and force path that the session
    // tells of is always allowed.
    Duration oldest_force{};
    GuardSettings guard;  // table [guard]: the last stage before the device
    // At the needle: velocity.quantum_m is position_scale x the encoder's step. sample_period is the one above.
    VelocitySettings velocity;
    ControlSettings control{};  // of table [control], in HF
    CodecSettings codec{};      // of table [codec]
};

// Tables [master], [control], [codec], and [guard] over the values of `guard`; throws Error (usage).
MasterSettings read_master_settings(const ConfigFile& file, const GuardSettings& guard = {});

class MasterNode {
  public:
    explicit MasterNode(const MasterSettings& settings);

    // network_delay: there and back, as configured. Waves and the first force wait for it, and a force may be as old.
    void start_trial(SessionTime now, Modality modality, Duration network_delay = {});
    void end_trial();
    // The network takes so long now, there and back.
    void network_changed(Duration network_delay);
    // Before anything else in a tick. After a long pause messages have waited that say nothing about now.
    void begin_tick(Duration since_last_tick) { stood_still_ = since_last_tick > settings_.stale.after; }

    // kNever outside of a trial.
    SessionTime next_sample() const { return next_sample_; }
    // True once for each sample that is due. Those that were missed are skipped.
    bool take_due(SessionTime now);
    // One encoder sample. Velocities are estimated at the needle.
    NeedleCommand sample(SessionTime now, const HandleSample& handle);
    // Messages carry waves, or the energies of two-port passivity: waves() goes with the sample's command.
    bool has_waves() const { return control_.waves(); }
    const WaveBurst& waves() const { return control_.burst(); }

    // Forces for the handle, positive pushes it out (-z), within +-force_limit_N; none: it keeps the one it has. Only HF drives
    // the handle. First the force at the newest sample, which a compensator computes, or a codec that predicts; call it once per sample.
    std::optional<double> force_at_sample_N(SessionTime now);
    std::optional<double> take(SessionTime now, const ForceFeedback& feedback);
    std::optional<double> take(SessionTime now, const ForceWave& wave);
    // Once per tick of a trial, last.
    std::optional<double> fade(SessionTime now);
    // Without news: silent, or with forces that are too late.
    bool stale(SessionTime now) const;

    // Skin and eyes report separately and at different rates. Both return the newest of both, for the operator.
    const Percept& feel(const Percept& skin);
    const Percept& see(const Percept& eyes);

    const RoundTrip& round_trip() const { return round_trip_; }  // of this trial
    Duration newest_age() const { return newest_age_; }          // of a force, also of a late one
    double force_hand_N() const { return force_hand_N_; }        // of the newest sample
    std::uint64_t samples() const { return samples_; }
    std::uint64_t samples_skipped() const { return samples_skipped_; }
    const HandleEnd* plugin() const { return control_.end_of_plugin(); }  // null: the session has none

  private:
    double handle_force_N(const ForceFeedback& feedback);
    Duration longest_age(Duration network_delay) const;
    Duration silence(SessionTime now) const;
    double share(SessionTime now) const;

    MasterSettings settings_;
    VelocityEstimator estimator_;
    HandleControl control_;  // in charge of the force if it is active
    Modality modality_ = Modality::kHF;
    SessionTime next_sample_ = kNever;
    SessionTime sampled_ = kNever;  // the newest sample; kNever: none in this trial
    bool stood_still_ = false;
    SessionTime heard_{};       // the newest force that was not late
    ForceAge age_;              // of it
    double asked_force_N_ = 0;  // by it
    ForceFill fill_;            // between two of them
    Percept percept_;           // newest of skin and eyes
    RoundTrip round_trip_;
    Duration newest_age_{}, heard_age_{};  // age on arrival: of the last force, of the one at heard_
    double force_hand_N_ = 0;
    std::uint64_t samples_ = 0, samples_skipped_ = 0;
};

}  // namespace thimble
