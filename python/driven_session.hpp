// A virtual session that a program steps, and whose handle it may move. It needs no Python.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "browser/live_trial.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "master/devices/pointer_handle.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {

enum class Driver : std::uint8_t { kOperator, kPython };  // who holds the handle

struct TrialChoice {
    TrialConditions conditions;  // those below are filled in
    std::optional<double> delay_s{}, fixture_m{};
    std::optional<std::uint64_t> seed{};
};

// SI units, as LiveState; values at the needle are undelayed.
struct DrivenState {
    double now_s = 0, time_s = 0;
    bool running = false, beeped = false;
    double needle_m = 0, surface_m = 0, fixture_m = 0, handle_m = 0;
    double force_hand_N = 0, force_finger_N = 0, force_bar_N = 0, force_tissue_N = 0, force_fixture_N = 0;
    double contact_s = 0;
    std::string finger, outcome = "none";
};

class DrivenSession {
  public:
    // Throws Error (usage) if a real person or an own program takes part.
    DrivenSession(SystemSettings settings, Driver driver);

    // A fresh session, as each trial of a study has. Throws Error (usage).
    void start(const TrialChoice& choice);
    // One instant; false once the trial has ended. Throws Error (usage) if none was started.
    bool step();
    // At most so many instants. False once the session's clock is at `until_s`, or the trial has ended.
    bool advance(double until_s, int instants);
    // Throws Error (usage): the hand is the virtual operator's, or the place is out of reach.
    void hand(double position_m, bool engaged);
    void change_delay(double delay_s);
    void stop();

    bool running() const { return session_ && !session_->session().finished(); }
    const TrialRecord& record() const { return started().session().record(); }
    DrivenState state();
    double timeout_s() const { return to_seconds(settings_.session.trial_timeout); }

  private:
    VirtualSession& started() const;
    TrialConditions conditions_of(const TrialChoice& choice) const;
    void follow();

    SystemSettings settings_;
    Driver driver_;
    HandInput input_{};
    SessionTime next_follow_{};
    std::unique_ptr<PointerHandle> pointer_;
    std::unique_ptr<SeenDisplay> display_;
    std::unique_ptr<SimulatedActuator> actuator_;
    std::unique_ptr<VirtualSession> session_;
};

}  // namespace thimble
