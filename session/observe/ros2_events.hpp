// The events and the state of a session, as texts, from its Monitors. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "session/log/ros2_topics.hpp"

namespace thimble {

class Ros2Events {
  public:
    // The events since the Monitor before, in the order of time. A Monitor that is lost delays an event, or a beep joins its trial's end.
    std::vector<std::string> events(std::uint32_t trial, const Monitor& m) {
        std::vector<std::string> events;
        const auto say = [&](ControlKind kind, std::uint32_t of) {
            events.push_back(ros2_event(kind, of, m.modality, m.network, m.network_delay_s));
        };
        const bool running = m.state == NodeState::kRunning;
        const bool begins = running && (!running_ || trial != trial_);
        if (running_ && (begins || !running)) say(ControlKind::kTrialEnd, trial_);
        if (begins) say(ControlKind::kTrialStart, trial);
        if (running && m.beeped && (begins || !beeped_)) say(ControlKind::kBeep, trial);
        if (heard_ && (m.network_delay_s != delay_s_ || m.network != network_))
            say(ControlKind::kNetworkChange, trial);
        heard_ = true;
        running_ = running;
        beeped_ = m.beeped;
        trial_ = trial;
        delay_s_ = m.network_delay_s;
        network_ = m.network;
        return events;
    }

  private:
    bool heard_ = false, running_ = false, beeped_ = false;
    std::uint32_t trial_ = 0;
    double delay_s_ = 0;
    NetworkName network_;
};

// "running trial 3 CF penetrated", "waiting", "waiting, last: timeout", "no session".
inline std::string ros2_state(std::uint32_t trial, const Monitor& m, bool silent) {
    if (silent) return "no session";
    if (m.state == NodeState::kRunning)
        return fmt::format("running trial {} {} {}", trial, to_string(m.modality), to_string(m.phase));
    if (m.reason == EndReason::kNone) return "waiting";
    return fmt::format("waiting, last: {}", to_string(m.reason));
}

}  // namespace thimble
