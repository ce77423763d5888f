// The newest Monitor of whichever session speaks, and how old it is. Sessions come and go: the next one is heard a second
// after the last has fallen silent (InboundFlow).
#pragma once

#include <cstdint>
#include <string_view>

#include "common/flow.hpp"
#include "common/messages.hpp"

namespace thimble {

// The view reports silence after this time. Twice a heartbeat's patience would hide a loss for a second.
inline constexpr Duration kMonitorSilence = std::chrono::milliseconds{500};
// A replay identifies itself ten times a second. A sender without that for this time is a session.
inline constexpr Duration kReplaySilence = std::chrono::seconds{1};

class MonitorReceiver {
  public:
    // `channel` outlives the receiver.
    explicit MonitorReceiver(Channel& channel) : channel_(&channel) {}

    // Empties the channel; `use(now, trial, monitor)` is called for each message, oldest first.
    template <class Use>
    void update(SessionTime now, Use&& use) {
        while (const Message* message = flow_.receive(now, *channel_)) {
            if (const auto* monitor = std::get_if<Monitor>(&message->body)) {
                keep(now, message->header, *monitor);
                use(now, trial_, monitor_);
            } else if (const auto* fault = std::get_if<DeviceFault>(&message->body)) {
                fault_ = *fault;
            } else if (const auto* replay = std::get_if<ReplayState>(&message->body)) {
                replay_ = *replay;
                replay_arrived_ = now;
            } else {
                flow_.refuse_admitted(Refusal::kUnexpectedKind);
            }
        }
    }

    // False: no session has spoken since this program started.
    bool heard() const { return heard_; }
    // True as well where nothing has been heard at all.
    bool silent(SessionTime now) const { return !heard_ || age(now) > kMonitorSilence; }
    // Of the newest message; Duration::max() without one.
    Duration age(SessionTime now) const { return heard_ ? now - arrived_ : Duration::max(); }

    const Monitor& newest() const { return monitor_; }  // as constructed before the first
    std::uint32_t trial() const { return trial_; }      // of the newest
    // State of the replay if the sender shows a recorded trial; else null.
    const ReplayState* replay() const {
        const bool said = replay_arrived_ != kNever && arrived_ - replay_arrived_ <= kReplaySilence;
        return said ? &replay_ : nullptr;
    }
    // Why a device has ended the newest trial: which one, what happened, what to do; empty if none has. It stays where the
    // session ends with it, until another one speaks.
    std::string_view fault() const { return fault_.words(); }
    const FlowCounters& counters() const { return flow_.counters(); }

  private:
    void keep(SessionTime now, const Header& header, const Monitor& monitor) {
        heard_ = true;
        arrived_ = now;
        trial_ = header.trial;
        monitor_ = monitor;
        if (monitor.reason != EndReason::kDeviceFault) fault_ = {};
    }

    Channel* channel_;
    InboundFlow flow_{Role::kSession};
    Monitor monitor_;
    std::uint32_t trial_ = 0;
    DeviceFault fault_;
    ReplayState replay_;
    SessionTime arrived_{}, replay_arrived_ = kNever;
    bool heard_ = false;
};

}  // namespace thimble
