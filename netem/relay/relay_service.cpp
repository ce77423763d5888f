#include "netem/relay/relay_service.hpp"

#include <algorithm>
#include <optional>
#include <sys/resource.h>

#include <spdlog/spdlog.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/control_server.hpp"
#include "netem/relay/packet_log.hpp"
#include "netem/relay/relay_engine.hpp"

namespace thimble {
namespace {

// How long a stop request may wait for a sleeping relay.
constexpr Duration kStopLatency = std::chrono::milliseconds{100};
constexpr std::size_t kOtherDescriptors = 32;

void say_ready(const RelaySettings& settings, const RelayEngine& engine) {
    for (std::size_t i = 0; i < settings.inlets.size(); ++i) {
        spdlog::info("ready: UDP {} -> {}, {:g} ms up, {:g} ms down, {} waiting",
                     to_string(engine.inlet_address(i)), to_string(settings.inlets[i].to),
                     1e3 * to_seconds(settings.links.up.delay), 1e3 * to_seconds(settings.links.down.delay),
                     engine.waiter().precise() ? "precise" : "sleeping");
    }
}

// Told once: from then on what is behind schedule is slept for.
void say_if_spinning_gave_up(const EventWaiter& waiter, bool& said) {
    if (said || waiter.counters().exhausted == 0) return;
    said = true;
    spdlog::warn("precise waiting would take more than 80 % of a core: sleeping instead while that is so");
}

void relay_until_stopped(RelayEngine& engine, ControlServer* control, SessionTime end) {
    bool said = false;
    SessionTime latest = wall_now() + kStopLatency;
    while (!stop_requested()) {
        engine.step(std::min(latest, end));
        if (control != nullptr) control->serve(engine);
        const SessionTime now = wall_now();
        if (now >= end) return;
        if (now < latest) continue;
        latest = now + kStopLatency;
        say_if_spinning_gave_up(engine.waiter(), said);
    }
}

}  // namespace

bool ask_for_precision(const RuntimeSettings& runtime, bool wanted) {
    const std::string refusal = ask_for_realtime(runtime);
    const bool granted = refusal.empty() && runtime.realtime_scheduling;
    if (!refusal.empty()) spdlog::warn(refusal);
    if (wanted && !granted)
        spdlog::warn("--precise needs real-time scheduling: sleeping instead of spinning");
    return wanted && granted;
}

void allow_descriptors(std::size_t wanted) {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) return;
    limit.rlim_cur = std::min<rlim_t>(wanted, limit.rlim_max);
    setrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_cur < wanted) {
        spdlog::warn("the system allows {} open files, {} flows may need {}: see ulimit -n", limit.rlim_cur,
                     wanted - kOtherDescriptors, wanted);
    }
}

RelayState run_relay(const ServiceSettings& settings) {
    allow_descriptors(settings.relay.most_flows + settings.relay.inlets.size() + kOtherDescriptors);
    std::optional<PacketLog> log;
    if (!settings.log.empty()) log.emplace(settings.log);
    std::optional<ControlServer> control;
    if (!settings.control.empty()) control.emplace(settings.control);
    install_stop_signals();
    RelaySettings relay = settings.relay;
    relay.precise = ask_for_precision(settings.runtime, relay.precise);
    RelayEngine engine(relay, log ? &*log : nullptr);
    say_ready(relay, engine);
    const SessionTime end = settings.length > Duration::zero() ? wall_now() + settings.length : kNever;
    relay_until_stopped(engine, control ? &*control : nullptr, end);
    RelayState state = engine.state(wall_now());
    control.reset();
    if (log) log->finish();
    return state;
}

}  // namespace thimble
