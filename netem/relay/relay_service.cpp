#include "netem/relay/relay_service.hpp"

#include <algorithm>
#include <optional>
#include <sys/resource.h>

#include <spdlog/spdlog.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/control_server.hpp"
#include "netem/relay/metrics_server.hpp"
#include "netem/relay/packet_log.hpp"
#include "netem/relay/relay_engine.hpp"
#include "netem/relay/relay_report.hpp"

namespace thimble {
namespace {

// How long a stop request may wait for a sleeping relay.
constexpr Duration kStopLatency = std::chrono::milliseconds{100};
constexpr std::size_t kOtherDescriptors = 32;

void say_ready(const RelaySettings& settings, const RelayEngine& engine) {
    for (std::size_t i = 0; i < settings.inlets.size(); ++i) {
        spdlog::info("ready: UDP {} -> {}, {:g} ms up, {:g} ms down, {} waiting",
                     to_string(engine.inlet_address(i)), to_string(settings.inlets[i].to),
                     1e3 * to_seconds(mean_delay(settings.links.up)),
                     1e3 * to_seconds(mean_delay(settings.links.down)),
                     engine.waiter().precise() ? "precise" : "sleeping");
    }
    const std::string up = order_text(settings.links.up), down = order_text(settings.links.down);
    if (!up.empty()) spdlog::info("up: {}", up);
    if (!down.empty()) spdlog::info("down: {}", down);
}

// Warns once per closed port: a server may start later.
void say_if_nobody_listens(const RelaySettings& settings, const RelayTotals& totals,
                           std::vector<bool>& said) {
    for (std::size_t i = 0; i < said.size(); ++i) {
        if (said[i] || totals.closed_ports[i] == 0) continue;
        said[i] = true;
        spdlog::warn(
            "nobody listens at UDP {}: its machine answers that the port is closed; is the server running?",
            to_string(settings.inlets[i].to));
    }
}

// Warns once: from then on the relay sleeps while it is behind schedule.
void say_if_spinning_gave_up(const EventWaiter& waiter, bool& said) {
    if (said || waiter.counters().exhausted == 0) return;
    said = true;
    spdlog::warn("precise waiting would take more than 80 % of a core, so the relay sleeps instead for now");
}

struct Servers {
    std::optional<ControlServer> control{};
    std::optional<MetricsServer> metrics{};
};

void relay_until_stopped(const RelaySettings& settings, RelayEngine& engine, Servers& servers,
                         SessionTime end) {
    bool said = false;
    std::vector<bool> said_closed(settings.inlets.size());
    SessionTime latest = wall_now() + kStopLatency;
    while (!stop_requested()) {
        engine.step(std::min(latest, end));
        if (servers.control) servers.control->serve(engine);
        if (servers.metrics) servers.metrics->serve(engine);
        const SessionTime now = wall_now();
        if (now >= end) return;
        if (now < latest) continue;
        latest = now + kStopLatency;
        say_if_spinning_gave_up(engine.waiter(), said);
        say_if_nobody_listens(settings, engine.counted(), said_closed);
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
        spdlog::warn("the system allows {} open files, but {} flows may need {}: see ulimit -n",
                     limit.rlim_cur, wanted - kOtherDescriptors, wanted);
    }
}

RelayState run_relay(const ServiceSettings& settings) {
    allow_descriptors(settings.relay.most_flows + settings.relay.inlets.size() + kOtherDescriptors);
    std::optional<PacketLog> log;
    if (!settings.log.empty()) log.emplace(settings.log);
    Servers servers;
    if (!settings.control.empty()) servers.control.emplace(settings.control);
    if (settings.metrics) servers.metrics.emplace(*settings.metrics);
    install_stop_signals();
    RelaySettings relay = settings.relay;
    relay.precise = ask_for_precision(settings.runtime, relay.precise);
    RelayEngine engine(relay, log ? &*log : nullptr);
    say_ready(relay, engine);
    if (servers.metrics) spdlog::info("metrics: http://{}/metrics", to_string(servers.metrics->address()));
    const SessionTime end = settings.length > Duration::zero() ? wall_now() + settings.length : kNever;
    relay_until_stopped(relay, engine, servers, end);
    RelayState state = engine.state(wall_now());
    servers.control.reset();
    servers.metrics.reset();
    if (log) state.log_fault = log->finish();
    return state;
}

}  // namespace thimble
