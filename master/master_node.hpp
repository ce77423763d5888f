// The master's logic: encoder reading in, needle command out; force feedback in, force at the handle out.
//
// Order inside a sample, fixed because it decides the zero-delay verdict by a factor of three (a delay of d
// samples needs b >= K h (2d + 1) / 2 of hand damping; docs/model.md): the handle is read, the command leaves
// at once, and the force is given to the handle the moment the answer arrives, not at the next sample. With
// no network delay the force that acts from sample k on belongs to the position of sample k: d = 0.
#pragma once

#include "common/config.hpp"
#include "common/control/control_settings.hpp"
#include "common/messages.hpp"
#include "common/shared_values.hpp"
#include "common/stale_policy.hpp"
#include "common/velocity_estimator.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/force_guard.hpp"
#include "master/handle_control.hpp"

namespace thimble {

struct MasterSettings {
    double position_scale = kPositionScale;     // needle = scale x hand
    double force_scale = 1;                     // handle force = scale x needle force
    double force_limit_N = kHandleFullScale_N;  // at the handle, before the device's own limit
    Duration sample_period = std::chrono::milliseconds{1};
    StalePolicy stale{StaleMode::kRamp};  // of the handle's force, without feedback
    // What is older, by stale.after, counts as no feedback. 0: the longest delay of needle and force path that the session
    // tells of.
    Duration oldest_force{};
    GuardSettings guard;  // table [guard]: the last stage before the device
    // At the needle: velocity.quantum_m is position_scale x the encoder's step. sample_period is the one above.
    VelocitySettings velocity;
    ControlSettings control{};  // of table [control], in HF
};

// Table [master], and with it [guard] and [control]; throws Error (usage).
MasterSettings read_master_settings(const ConfigTable& table);
MasterSettings read_master_settings(const ConfigFile& file);

class MasterNode {
  public:
    explicit MasterNode(const MasterSettings& settings);

    // network_delay: there and back, as configured; what waves wait for.
    void start_trial(Modality modality, Duration network_delay = {});
    void end_trial();

    // One encoder sample. Velocities are estimated at the needle.
    NeedleCommand sample(SessionTime now, const HandleSample& handle);

    // Force for the handle, of HF without a compensator or with a share of it; positive pushes the hand out (-z), within +-force_limit_N. Only HF drives the
    // handle.
    double handle_force_N(const ForceFeedback& feedback) const;

    // The compensator of this trial, if one works at samples: then its force is the handle's.
    HandleControl& control() { return control_; }
    const HandleControl& control() const { return control_; }

    const MasterSettings& settings() const { return settings_; }

  private:
    MasterSettings settings_;
    VelocityEstimator estimator_;
    HandleControl control_;
    Modality modality_ = Modality::kHF;
    bool running_ = false;
    bool placed_ = false;  // the estimator knows where the needle starts
};

}  // namespace thimble
