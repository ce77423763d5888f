// The simulated slave: a needle in a scene, tissue before a virtual fixture. Pure logic, no clock: time is what the
// commands carry, on the master's clock.
//
// The tissue follows the smooth position of a command, whose slope is the estimated velocity: raw encoder
// steps would make the needle's velocity jump by more than the puncture force allows. The fixture, the proxy
// and the contact time follow the encoder's reading, undelayed.
#pragma once

#include <cstdint>
#include <optional>

#include "common/control/controller_ends.hpp"
#include "common/messages.hpp"
#include "common/time.hpp"
#include "common/velocity_estimator.hpp"
#include "slave_sim/contact_timer.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/slave_settings.hpp"

namespace thimble {

class SlaveNode {
  public:
    // No command places the needle further from the origin; one that does (or is not a number, or is
    // from before the clock's origin) is refused.
    static constexpr double kFarthestNeedleMetres = 10;

    // The scene has tissue and a forbidden region (asserted).
    explicit SlaveNode(const SlaveSettings& settings);

    // Everything at rest, fixture as ordered, no contact. The next command only sets the needle.
    void start_trial(const SessionControl& order);
    // Moves, removes or returns the fixture. Contact time goes on if the needle still touches it.
    void change_fixture(const SessionControl& order);
    // Outside a trial every force is zero.
    void end_trial();

    // One sample of the needle. The answer carries the sample's time and sequence; hold_time is the caller's
    // to fill. A refused command, or one that is not newer than the last, moves nothing and is answered with
    // the state as it was. After a gap longer than longest_step the needle is taken to have waited, then
    // moved within longest_step; contact starts anew.
    ForceFeedback on_needle(SessionTime sample_time, std::uint32_t sequence, const NeedleCommand& command);

    // The same with a needle that a robot moves: where it is, and the force that it feels in the place of the tissue's.
    ForceFeedback on_robot(SessionTime sample_time, std::uint32_t sequence, double position_m,
                           double force_N);

    // The same with the slave's end of a controller, such as wave variables. It steps each of the master's samples
    // since the last message, then answers the newest. The controller's end decides where the needle goes.
    // wave_burst() is sent with the answer. Only while waves().
    ForceFeedback on_wave(SessionTime sample_time, std::uint32_t sequence, const NeedleWave& message);
    bool waves() const { return in_trial_ && waves_; }
    const WaveBurst& wave_burst() const { return burst_; }
    const SlaveEnd* plugin() const { return end_ && !end_->file().empty() ? &*end_ : nullptr; }

    // Between two commands: the needle stands, tissue waits for the next command, and forces are what they were.
    ForceFeedback still(SessionTime sample_time) const {
        ForceFeedback feedback = answer();
        feedback.echo_time = sample_time;
        return feedback;
    }

    // Commands stopped: the needle is held where it is, every force is zero and contact is lost.
    ForceFeedback hold();

    // True exactly once after the beep became due.
    bool take_beep() {
        const bool due = beep_due_;
        beep_due_ = false;
        return due;
    }

    // The changes during the last command's step; offsets from the previous sample.
    const Transitions& events() const { return scene_.transitions(); }
    std::uint64_t refused() const { return refused_; }

  private:
    void follow(SessionTime sample_time, const NeedleCommand& command);
    void advance(SessionTime sample_time, const NeedleSample& needle);
    void step(Duration duration, const NeedleSample& needle);
    ForceFeedback answer() const;
    NeedleCommand wave_step(SessionTime sample_time);

    SlaveSettings settings_;
    NeedleScene scene_;
    ContactTimer timer_;
    Duration scene_time_{};  // since the first command of the trial
    SessionTime sample_time_{};
    std::uint64_t refused_ = 0;
    std::uint32_t sequence_ = 0;
    std::optional<SlaveEnd> end_;  // where the session has one
    WaveBurst burst_;              // its newest
    VelocityEstimator
        wave_estimator_;  // of the needle that waves or a robot lead: tissue follows its smooth position
    std::optional<double> force_robot_N_;
    bool waves_ = false;  // in this trial
    bool in_trial_ = false;
    bool needle_known_ = false;
    bool held_ = false;
    bool beep_due_ = false;
};

}  // namespace thimble
