// thimble-netem set | show | watch: a running relay, by its control socket.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/json_text.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/commands/commands.hpp"
#include "netem/relay/control_server.hpp"
#include "netem/relay/relay_report.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

struct ControlOptions {
    std::string control;
    std::vector<std::string> assignments;
    bool json = false;
    int lines = 0;
};

std::shared_ptr<ControlOptions> options_of(CLI::App& command) {
    auto options = std::make_shared<ControlOptions>();
    command.add_option("--control", options->control, "socket that the relay was started with")
        ->type_name("PATH")
        ->required();
    command.add_flag("--json", options->json, "print the whole answer as JSON on stdout");
    return options;
}

int set(const ControlOptions& options) {
    std::string request = "set";
    for (const std::string& assignment : options.assignments) request += "\n" + assignment;
    const Json answer = ask_relay(options.control, request);
    if (options.json) {
        fmt::print("{}\n", json_text(answer, 2));
    } else {
        fmt::print("up   {}\ndown {}\n", json_text(answer.at("up").at("asked")),
                   json_text(answer.at("down").at("asked")));
    }
    return 0;
}

int show(const ControlOptions& options) {
    const Json answer = ask_relay(options.control, "show");
    fmt::print("{}", options.json ? json_text(answer, 2) + "\n" : report_text(answer));
    return 0;
}

std::uint64_t packets(const Json& answer, const char* direction, const char* what) {
    return answer.at(direction).at("packets").at(what).get<std::uint64_t>();
}

// One line with the changes since the last answer.
std::string line(const Json& before, const Json& now) {
    std::string text = fmt::format("{:8.1f} s  {:4} flows", now.at("running_s").get<double>(),
                                   now.at("flows").at("open").get<std::uint64_t>());
    const double running_s = now.at("running_s").get<double>(),
                 before_s = before.at("running_s").get<double>();
    const bool anew = running_s < before_s;  // another relay, which began to count since then
    const double passed_s = running_s - (anew ? 0 : before_s);
    for (const char* direction : {"up", "down"}) {
        const auto count = [&](const char* what) {
            return packets(now, direction, what) - (anew ? 0 : packets(before, direction, what));
        };
        const Json& error = now.at(direction).at("due_time_error");
        text += fmt::format(" | {:<4} {:7.0f}/s in {:7.0f}/s out {:5} lost, late {:.1f} us p50 {:.1f} p99",
                            direction, static_cast<double>(count("received")) / passed_s,
                            static_cast<double>(count("sent")) / passed_s, count("lost"),
                            error.at("median_us").get<double>(), error.at("p99_us").get<double>());
    }
    return text;
}

int watch(const ControlOptions& options) {
    install_stop_signals();
    Json before = ask_relay(options.control, "show");
    for (int lines = 0; !stop_requested() && (options.lines == 0 || lines < options.lines); ++lines) {
        wall_sleep(std::chrono::seconds{1});
        if (stop_requested()) break;
        Json now = ask_relay(options.control, "show");
        fmt::print("{}\n", options.json ? json_text(now) : line(before, now));
        flush_results();
        before = std::move(now);
    }
    return 0;
}

}  // namespace

NetemCommand add_set(CLI::App& app) {
    CLI::App* command = app.add_subcommand("set", "change the network of a running relay");
    const auto options = options_of(*command);
    command
        ->add_option("assignments", options->assignments,
                     "KEY=VALUE as in a profile file; up. or down. before it for one direction")
        ->required();
    command->footer(
        "Example:\n  thimble-netem set --control /tmp/netem up.delay_s=0.1 loss=0.01 jitter=normal "
        "jitter_spread_s=0.005");
    return {command, [options] { return set(*options); }};
}

NetemCommand add_show(CLI::App& app) {
    CLI::App* command = app.add_subcommand("show", "show the settings and counters of a running relay");
    const auto options = options_of(*command);
    command->footer("Example:\n  thimble-netem show --control /tmp/netem --json");
    return {command, [options] { return show(*options); }};
}

NetemCommand add_watch(CLI::App& app) {
    CLI::App* command = app.add_subcommand("watch", "print one line per second about a running relay");
    const auto options = options_of(*command);
    command->add_option("--lines", options->lines, "end after this many lines; 0: never")
        ->check(CLI::Range(0, 1000000));
    command->footer("Example:\n  thimble-netem watch --control /tmp/netem");
    return {command, [options] { return watch(*options); }};
}

}  // namespace thimble
