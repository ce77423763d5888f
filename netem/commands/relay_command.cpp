// thimble-netem --listen ... --to ...: a network in front of any UDP program. With --selftest: in front of its own.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "netem/commands/commands.hpp"
#include "netem/commands/network_options.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/relay/relay_service.hpp"
#include "netem/relay/selftest.hpp"

namespace thimble {
namespace {

struct RelayOptions {
    std::vector<std::string> listen, to;
    NetworkOptions network;
    std::size_t most_flows = 1000;
    double idle_s = 60, seconds = 0;
    bool precise = false, json = false, strict_rt = false, default_scheduling = false, selftest = false;
    std::string log, control, metrics, print_tc;
};

// The same for the kernel's netem, and what it does not do. A qdisc holds for what leaves its device: DEVICE is on the way
// to the server, and DEVICE,DEVICE names that and the one on the way to the clients.
void print_tc_commands(const Network& network, const std::string& devices) {
    const std::size_t comma = devices.find(',');
    const std::string to_server = devices.substr(0, comma);
    const std::string to_clients = comma == std::string::npos ? devices : devices.substr(comma + 1);
    const auto print_way = [](const std::string& way, const LinkSettings& link, const Timeline& changes,
                              const std::string& device) {
        fmt::print("# {}\n", way);
        if (!changes.empty())
            fmt::print("# differs: {} changes with time; tc would need a script\n", changes.size());
        if (link == LinkSettings{}) return fmt::print("# no netem is needed in this direction\n");
        const TcCommands tc = print_tc(link, device);
        fmt::print("{}\n", tc.command);
        for (const std::string& gap : tc.cannot) fmt::print("# differs: {}\n", gap);
    };
    const bool one = comma == std::string::npos;
    print_way(fmt::format("up: {} at its device towards the server",
                          one ? "on the clients' machine," : "on a router,"),
              network.links.up, network.timelines.up, to_server);
    print_way(fmt::format("down: {} at its device towards the clients",
                          one ? "on the server's machine," : "on a router,"),
              network.links.down, network.timelines.down, to_clients);
}

// A bare port is that of all addresses, of IPv6 as well where this machine has it.
UdpAddress listen_address(const std::string& text) {
    const UdpAddress local = read_udp_address(text, "--listen");
    if (text.find(':') != std::string::npos) return local;
    try {
        UdpSocket::open(AF_INET6);
        return UdpAddress::all(local.port);
    } catch (const Error&) {
        return local;
    }
}

// A bare port is this machine's alone: metrics are for who is trusted.
UdpAddress metrics_address(const std::string& text) {
    return read_udp_address(text.find(':') == std::string::npos ? "127.0.0.1:" + text : text, "--metrics");
}

RelaySettings relay_settings(const RelayOptions& options) {
    if (options.listen.size() != options.to.size() || options.listen.empty()) {
        throw Error(ExitCode::kUsage,
                    "{} times --listen and {} times --to: give one --to HOST:PORT for each --listen PORT",
                    options.listen.size(), options.to.size());
    }
    RelaySettings relay;
    for (std::size_t i = 0; i < options.listen.size(); ++i) {
        const UdpAddress to = read_udp_address(options.to[i], "--to");
        if (to.unspecified() || to.port == 0) {
            throw Error(ExitCode::kUsage, "--to {}: write HOST:PORT or [IPv6]:PORT of the server",
                        options.to[i]);
        }
        relay.inlets.push_back({listen_address(options.listen[i]), to});
    }
    Network network = read_network(options.network);
    relay.links = std::move(network.links);
    relay.timelines = std::move(network.timelines);
    relay.seed = network.seed;
    relay.most_flows = options.most_flows;
    relay.idle = from_seconds(options.idle_s);
    relay.precise = options.precise;
    return relay;
}

// Share of packets that left late beyond what --strict-rt allows.
int check_lateness(const RelayOptions& options, const RelayState& state, const RuntimeSettings& runtime) {
    std::uint64_t late = 0, sent = 0;
    for (const DirectionTotals& d : state.totals.direction) {
        late += d.late;
        sent += d.error.count();
    }
    if (!options.strict_rt || share_of(late, sent) <= runtime.allowed_miss_fraction)
        return static_cast<int>(ExitCode::kOk);
    spdlog::error("{} of {} packets left more than 1 ms late; --strict-rt allows a fraction of {}", late,
                  sent, runtime.allowed_miss_fraction);
    return static_cast<int>(ExitCode::kRealtime);
}

int relay(const RelayOptions& options) {
    ServiceSettings service;
    service.relay = relay_settings(options);
    service.runtime.realtime_scheduling = !options.default_scheduling;
    service.log = options.log;
    service.control = options.control;
    if (!options.metrics.empty()) service.metrics = metrics_address(options.metrics);
    service.length = from_seconds(options.seconds);
    const RelayState state = run_relay(service);
    const auto report = describe(state);
    fmt::print("{}", options.json ? json_text(report, 2) + "\n" : report_text(report));
    if (!state.log_fault.empty()) throw Error(ExitCode::kData, state.log_fault);
    return check_lateness(options, state, service.runtime);
}

int selftest(const RelayOptions& options) {
    SelftestSettings settings = selftest_settings(options.network, options.seconds);
    settings.precise = options.precise;
    settings.runtime.realtime_scheduling = !options.default_scheduling;
    return run_and_print(settings, *make_relay_path(), options.json);
}

void add_traffic_options(CLI::App& app, RelayOptions& o) {
    app.add_option("--listen", o.listen, "where clients send to; give it several times for several servers")
        ->type_name("[HOST:]PORT")
        ->take_all();
    app.add_option("--to", o.to, "where the server is; one for each --listen")
        ->type_name("HOST:PORT")
        ->take_all();
    add_network_options(app, o.network);
    app.add_option("--max-flows", o.most_flows, "most clients at the same time")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--idle-s", o.idle_s, "forget a client after this silence, s")
        ->check(CLI::Range(0.1, 86400.0))
        ->capture_default_str();
}

void add_run_options(CLI::App& app, RelayOptions& o) {
    app.add_option("--seconds", o.seconds, "end after this time, s (default never; with --selftest 10)")
        ->check(CLI::Range(0.1, 86400.0));
    app.add_flag(
        "--precise", o.precise,
        "busy-wait before each send: microseconds of error instead of tens, at the cost of processor time");
    app.add_flag("--default-scheduling", o.default_scheduling, "do not ask for real-time scheduling");
    app.add_flag("--strict-rt", o.strict_rt, "exit with 4 if more than 1 in 1000 packets left 1 ms late");
    app.add_option("--log", o.log, "write the fate of each packet; as text if the name ends in .csv")
        ->type_name("FILE");
    app.add_option("--control", o.control, "make a socket for the commands set, show and watch")
        ->type_name("PATH");
    app.add_option("--metrics", o.metrics, "serve metrics for Prometheus at /metrics")
        ->type_name("[HOST:]PORT");
    app.add_flag("--json", o.json, "print the summary as JSON on stdout, instead of text");
    app.add_option("--print-tc", o.print_tc,
                   "only print the same network as tc commands, for its device to the server and its device "
                   "to the clients")
        ->type_name("DEVICE[,DEVICE]");
    CLI::Option* tests_itself = app.add_flag(
        "--selftest", o.selftest, "send test traffic and report whether this machine is accurate enough");
    for (const char* of_traffic : {"--listen", "--to", "--max-flows", "--idle-s", "--strict-rt", "--log",
                                   "--control", "--metrics", "--print-tc"})
        tests_itself->excludes(of_traffic);
}

}  // namespace

std::function<int()> add_relay(CLI::App& app) {
    const auto options = std::make_shared<RelayOptions>();
    add_traffic_options(app, *options);
    add_run_options(app, *options);
    return [options] {
        if (options->print_tc.empty()) return options->selftest ? selftest(*options) : relay(*options);
        print_tc_commands(read_network(options->network), options->print_tc);
        return 0;
    };
}

}  // namespace thimble
