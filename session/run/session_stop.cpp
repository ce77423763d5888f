#include "session/run/session_stop.hpp"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

// Stop keys that a run of this program has carried out. One pressed between two runs is the next run's.
std::atomic<unsigned> keys_carried_out{0};

}  // namespace

SessionStop::SessionStop(SessionProcess& session, const ConditionPlan& plan)
    : session_(session), plan_(plan), file_(plan.network.base_port), heard_(keys_carried_out) {}

void SessionStop::look() {
    hear_key();
    keep();
}

void SessionStop::hear_key() {
    const unsigned pressed = emergency_stops();
    if (pressed == heard_) return;
    heard_ = keys_carried_out = pressed;
    session_.emergency_stop(wall_now(), "Ctrl-\\ at thimble's terminal");
}

void SessionStop::keep() {
    if (!stopped() && !kept_) return;
    kept_ = stopped();
    try {
        if (kept_) {
            file_.keep(who());
        } else {
            file_.release(file_.kept());
        }
        fault_.clear();
    } catch (const Error& error) {
        if (fault_.empty())
            write_stderr(fmt::format("a stop that is not kept ends with this program: {}\n", error.what()));
        fault_ = fmt::format("; it ends with this program, since it could not be kept: {}", error.what());
    }
}

std::string SessionStop::who() const {
    const StopBus& bus = session_.stop_bus();
    return fmt::format("{} ({}): {}",
                       bus.reason() == EndReason::kSafetyStop ? "safety stop" : "emergency stop",
                       to_string(bus.raised_by()), bus.words());
}

std::string SessionStop::how_to_release() const {
    const int base = plan_.network.base_port;
    const auto& hosts = plan_.network.hosts;
    const bool by_file = plan_.network.security.mode != SecurityMode::kNone ||
                         std::any_of(hosts.begin(), hosts.end(), leaves_this_machine);
    std::string how(kHowToRelease);
    if (by_file && !plan_.session_file.empty()) how += " " + plan_.session_file.string();
    if (base != NetworkSettings::kDefaultBasePort) how += fmt::format(" --base-port {}", base);
    return how + fault_;
}

std::string SessionStop::words() const {
    return stopped() ? fmt::format("{}; {}", who(), how_to_release()) : std::string();
}

}  // namespace thimble
