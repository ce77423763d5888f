// A stop of a session, as its program sees it: it hears the stop key, keeps the stop in a file, and says how to release it.
#pragma once

#include <atomic>
#include <string>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/run/condition_plan.hpp"
#include "session/run/stop_file.hpp"

namespace thimble {

// Count of stop keys that runs of this program have handled. A key pressed between two runs counts for the next run.
inline std::atomic<unsigned> keys_carried_out{0};

class SessionStop {
  public:
    // Both outlive this.
    SessionStop(SessionProcess& session, const ConditionPlan& plan)
        : session_(session), plan_(plan), file_(plan.network.base_port), heard_(keys_carried_out) {}

    // Throws Error (run failed) if a stop of an earlier session holds.
    void require_released() const { file_.require_released(); }
    // Hears the stop key. Afterwards the file says what the stop bus holds.
    void look() {
        hear_key();
        keep();
    }

    bool stopped() const { return session_.stop_bus().stopped(); }
    // Of a stop: its source, its reason and how to release it. Empty: no stop holds.
    std::string words() const {
        return stopped() ? fmt::format("{}; {}", who(), how_to_release()) : std::string();
    }

    std::string how_to_release() const {
        const int base = plan_.network.base_port;
        const SecuritySettings& security = plan_.network.security;
        const bool by_file = security.mode != SecurityMode::kUserKey || !security.rig.empty() ||
                             plan_.network.hosts != NetworkSettings::every_role_here();
        std::string how(kHowToRelease);
        if (by_file && !plan_.session_file.empty()) how += " " + plan_.session_file.string();
        if (base != NetworkSettings::kDefaultBasePort) how += fmt::format(" --base-port {}", base);
        return how + fault_;
    }

  private:
    void hear_key() {
        const unsigned pressed = emergency_stops();
        if (pressed == heard_) return;
        heard_ = keys_carried_out = pressed;
        session_.emergency_stop(wall_now(), "Ctrl-\\ in the terminal of thimble");
    }

    // It prints a failure once, and tries again at each call.
    void keep() {
        const bool holds = stopped();
        if (!holds && !kept_) return fault_.clear();
        try {
            if (holds) {
                file_.keep(who());
            } else {
                file_.release(file_.kept());
            }
            kept_ = holds;
            fault_.clear();
        } catch (const Error& error) {
            if (fault_.empty()) tell(holds, error.what());
            fault_ = fmt::format("; {}: {}",
                                 holds ? "it ends with this program, because it cannot be saved"
                                       : "the file of an earlier stop is still there",
                                 error.what());
        }
    }

    static void tell(bool holds, const char* why) {
        write_stderr(fmt::format("warning: {}: {}\n",
                                 holds ? "this stop is not saved, and ends with this program"
                                       : "the stop was released, but its file is still there",
                                 why));
    }

    std::string who() const {
        const StopBus& bus = session_.stop_bus();
        return printable(fmt::format(
            "{} ({}): {}", bus.reason() == EndReason::kSafetyStop ? "safety stop" : "emergency stop",
            to_string(bus.raised_by()), bus.words()));
    }

    SessionProcess& session_;
    const ConditionPlan& plan_;
    StopFile file_;
    unsigned heard_;     // of emergency_stops()
    bool kept_ = false;  // in the file
    std::string fault_;  // why it could not be kept or removed; empty: it could
};

}  // namespace thimble
