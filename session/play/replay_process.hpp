// Shows a recorded trial: plays the session and slave_sim to thimble-visual, and the session to a view. The subject's
// screen gets the picture at once and the force later by the delay of then; the Monitor is undelayed, as always.
// Views also hear what their scrub bars are made of (ReplayState). No clock, no socket.
#pragma once

#include "common/flow.hpp"
#include "common/process.hpp"
#include "common/time.hpp"
#include "session/play/recorded_trial.hpp"
#include "session/play/session_observer.hpp"

namespace thimble {

// Where in a recording a replay is: runs at a speed, stands still, jumps. Time is an argument; it never goes beyond either end.
class ReplayClock {
  public:
    static constexpr double kSlowest = 0.01, kFastest = 100;

    // Stands at 0 until resume().
    explicit ReplayClock(double duration_s, double speed = 1);

    double time_s(SessionTime now) const;
    void resume(SessionTime now);
    void pause(SessionTime now);
    // Clipped to the recording, and to kSlowest to kFastest. Whether it runs stays as it is.
    void seek(SessionTime now, double time_s);
    void set_speed(SessionTime now, double speed);

    bool at_end(SessionTime now) const { return time_s(now) >= duration_s_; }
    double speed() const { return speed_; }

  private:
    double duration_s_, speed_;
    double anchor_s_ = 0;  // in the recording, at since_
    SessionTime since_{};
    bool running_ = false;
};

class ReplayProcess final : public Process, public OrderHandler {
  public:
    struct Channels {
        Channel* control;  // with thimble-visual
        Channel* force;    // to it, in slave_sim's name
        Channel* scene;    // picture and beep
        ViewChannels views;
    };

    // `trial` outlives the process.
    ReplayProcess(std::uint64_t instance, const RecordedTrial& trial, double speed, const Channels& channels);

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return next_; }
    bool stopped() const override { return quit_; }
    std::optional<Refusal> obey(SessionTime now, const Order& order) override;

    // thimble-visual has taken up the trial; a jump back over the beep changes nothing.
    bool shows() const { return shown_ || number_ > 1; }
    void shut_down(SessionTime now);

  private:
    void listen(SessionTime now);
    void steer(SessionTime now);
    void show(SessionTime now);
    void rest(SessionTime now);
    void beep(SessionTime now, double shown_s);
    Monitor monitor(SessionTime now) const;
    void begin_anew();

    const RecordedTrial* trial_;
    Channels channels_;
    ReplayClock clock_;
    InboundFlow answers_{Role::kVisual};
    OutboundFlow control_, force_, scene_, monitor_;
    OrderTaker experimenter_, player_;
    ReplayState state_;
    std::uint32_t number_ = 1;
    bool shown_ = false, wants_to_run_ = true, quit_ = false;
    int beeps_ = 0;  // said in this trial
    Heartbeat visual_;
    SessionTime next_{}, next_steer_{}, next_state_{};
};

// The marks on the scrub bar of this trial, at speed 1. Changes of the network that lie closer than a hundredth of the trial are one
// mark.
ReplayState replay_state_of(const RecordedTrial& trial);

}  // namespace thimble
