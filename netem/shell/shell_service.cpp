#include "netem/shell/shell_service.hpp"

#include <algorithm>
#include <linux/sockios.h>
#include <optional>
#include <sys/ioctl.h>

#include <spdlog/spdlog.h>

#include "common/runtime/wall_clock.hpp"
#include "netem/relay/control_server.hpp"
#include "netem/relay/packet_log.hpp"
#include "netem/relay/relay_report.hpp"
#include "netem/relay/relay_service.hpp"
#include "netem/shell/packet_relay.hpp"
#include "netem/shell/programs.hpp"
#include "netem/shell/uplink.hpp"

namespace thimble {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{100};  // at programs, without a signal
constexpr Duration kQuiet = std::chrono::milliseconds{20};  // for so long nothing waited: nothing is to come
constexpr Duration kLinger = std::chrono::seconds{2};  // beyond the delays, for what ended programs have sent
constexpr Duration kMostLinger = std::chrono::minutes{1};  // for connections that go on by themselves

std::vector<std::unique_ptr<ProgramRoom>> make_rooms(const std::vector<RoomSettings>& settings) {
    std::vector<std::unique_ptr<ProgramRoom>> rooms;
    rooms.reserve(settings.size());
    for (const RoomSettings& room : settings) rooms.push_back(std::make_unique<ProgramRoom>(room));
    return rooms;
}

Environment pair_environment(std::size_t i, bool has_ip6) {
    const TunAddress own = pair_address(i), peer = pair_address(1 - i);
    Environment environment{{"THIMBLE_HOST", peer.ip4}, {"THIMBLE_OWN", own.ip4}};
    if (has_ip6) {
        environment.emplace_back("THIMBLE_HOST6", peer.ip6);
        environment.emplace_back("THIMBLE_OWN6", own.ip6);
    }
    return environment;
}

// Packets of ended programs may still be under way. The kernel sends on for them, and goes on with their connections.
class Linger {
  public:
    explicit Linger(const LinkPair& links)
        : longest_(kLinger + nearly_longest_delay(links.up) + nearly_longest_delay(links.down)) {}
    bool over(SessionTime now, bool quiet, SessionTime tcp_read) {
        if (begin_ == kNever) begin_ = now;
        if (!quiet || quiet_since_ == kNever) quiet_since_ = quiet ? now : kNever;
        const SessionTime last = std::clamp(tcp_read, begin_, begin_ + kMostLinger);
        return now - last >= longest_ || (quiet && now - quiet_since_ >= kQuiet);
    }

  private:
    Duration longest_;
    SessionTime begin_ = kNever, quiet_since_ = kNever;
};

// slirp4netns has read its frames; it is ended with those that it has not.
bool all_read(const std::vector<PacketPort>& ports) {
    return std::none_of(ports.begin(), ports.end(), [](const PacketPort& port) {
        int unread_bytes = 0;
        return port.ethernet && ioctl(port.descriptor, SIOCOUTQ, &unread_bytes) == 0 && unread_bytes > 0;
    });
}

void relay_until_ended(PacketRelay& relay, Programs& programs, SignalLine& signals, ControlServer* control,
                       const std::vector<PacketPort>& outer, Linger linger) {
    for (;;) {
        SessionTime now = wall_now();
        const bool read = relay.step(now + (programs.all_ended() ? kQuiet / 4 : kLook));
        if (control != nullptr) control->serve(relay);
        now = wall_now();
        while (const auto signal = signals.next()) programs.obey(*signal, now);
        programs.look(now);
        const bool quiet = !read && relay.empty() && all_read(outer);
        if (!programs.all_ended() || !linger.over(now, quiet, relay.tcp_read())) continue;
        if (!quiet && now - relay.tcp_read() < kLook)
            spdlog::warn("a connection of an ended program still had data to send: they are lost");
        return;
    }
}

PacketPort port_of(const ProgramRoom& room) { return {.descriptor = room.device(), .stamps = room.stamps()}; }

// Where the time of a packet went; its lateness is the due_time_error of the report.
nlohmann::ordered_json describe_stages(const LinkSettings& link, const PacketRelay& relay,
                                       RelayDirection direction) {
    const StageTotals& stages = relay.stages(direction);
    return {{"queue_and_jitter", describe(stages.queue)},
            {"rate_mean_us", stages.rate_mean_us()},
            {"delay_us", 1e6 * to_seconds(mean_delay(link))}};
}

nlohmann::ordered_json describe_sending(const SendingTotals& sending) {
    return {{"waking", describe(sending.waking)},
            {"handling", describe(sending.handling)},
            {"writing", describe(sending.writing)}};
}

struct Wiring {
    PacketPort inner;
    std::vector<PacketPort> outer;
    std::vector<Environment> environments;
};

ShellResult run_wired(const ShellSettings& settings, Programs& programs, SignalLine& signals,
                      const Wiring& wiring) {
    std::optional<PacketLog> log;
    if (!settings.log.empty()) log.emplace(settings.log);
    std::optional<ControlServer> control;
    if (!settings.control.empty()) control.emplace(settings.control);
    const bool precise = ask_for_precision(settings.runtime, settings.precise);
    PacketRelay relay(
        {settings.links, settings.timelines, settings.seed, precise, wiring.inner, wiring.outer},
        log ? &*log : nullptr, signals.descriptor());
    for (std::size_t i = 0; i < wiring.environments.size(); ++i) programs.start(i, wiring.environments[i]);
    relay_until_ended(relay, programs, signals, control ? &*control : nullptr, wiring.outer,
                      Linger(settings.links));
    ShellResult result{programs.exit_code(), describe(relay.state(wall_now()))};
    result.report["shell"] = {{"no_ip_packets", relay.ports().garbage},
                              {"kernel_packets", relay.ports().local},
                              {"ends_closed", relay.ports().ports_closed},
                              {"sending", describe_sending(relay.sending())},
                              {"up", describe_stages(settings.links.up, relay, RelayDirection::kUp)},
                              {"down", describe_stages(settings.links.down, relay, RelayDirection::kDown)}};
    control.reset();
    if (log) result.log_fault = log->finish();
    return result;
}

// No process stays, also behind an exception. It goes before the rooms, whose devices the processes still have.
struct Sweeper {
    pid_t spared = -1;
    ~Sweeper() { end_descendants(spared); }
};

ShellResult run_one(const ShellSettings& settings, SignalLine& signals) {
    Uplink uplink;
    Programs programs(make_rooms({{.command = settings.commands[0],
                                   .addresses = uplink.program_addresses(),
                                   .name_server = uplink.name_server()}}),
                      uplink.slirp());
    const Sweeper sweeper{uplink.slirp()};
    const Environment environment = uplink.environment(programs.room(0).has_ip6());
    spdlog::info("this machine is {}{}, {:g} ms up, {:g} ms down", environment[0].second,
                 environment.size() > 1 ? " and " + environment[1].second : "",
                 1e3 * to_seconds(mean_delay(settings.links.up)),
                 1e3 * to_seconds(mean_delay(settings.links.down)));
    return run_wired(settings, programs, signals, {port_of(programs.room(0)), uplink.ports(), {environment}});
}

ShellResult run_two(const ShellSettings& settings, SignalLine& signals) {
    Programs programs(
        make_rooms({{.command = settings.commands[0], .addresses = {pair_address(0)}, .own_input = false},
                    {.command = settings.commands[1], .addresses = {pair_address(1)}}}));
    const Sweeper sweeper;
    return run_wired(
        settings, programs, signals,
        {port_of(programs.room(0)),
         {port_of(programs.room(1))},
         {pair_environment(0, programs.room(0).has_ip6()), pair_environment(1, programs.room(1).has_ip6())}});
}

}  // namespace

TunAddress pair_address(std::size_t i) {
    return {fmt::format("10.77.0.{}", i + 1), fmt::format("fd77::{}", i + 1), 24, 64};
}

ShellResult run_shell(const ShellSettings& settings) {
    SignalLine signals;
    adopt_orphans();
    return settings.commands.size() == 1 ? run_one(settings, signals) : run_two(settings, signals);
}

}  // namespace thimble
