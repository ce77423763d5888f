// thimble-netem shell [-- PROGRAM]: all that a program says passes a link. thimble-netem pair -- A -- B: a link between two.
#include <algorithm>
#include <cstdlib>
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
#include "netem/relay/relay_report.hpp"
#include "netem/shell/shell_selftest.hpp"
#include "netem/shell/shell_service.hpp"

namespace thimble {
namespace {

struct ShellOptions {
    NetworkOptions network;
    std::string log, control;
    double seconds = 0;
    bool precise = false, json = false, default_scheduling = false, selftest = false;
};

// The command lines after each "--".
std::vector<std::vector<std::string>> split_commands(const std::vector<std::string>& words) {
    std::vector<std::vector<std::string>> commands;
    for (const std::string& word : words) {
        if (word == "--") {
            commands.emplace_back();
        } else {
            commands.back().push_back(word);
        }
    }
    return commands;
}

int selftest(const ShellOptions& options) {
    SelftestSettings settings = selftest_settings(options.network, options.seconds);
    settings.precise = options.precise;
    settings.runtime.realtime_scheduling = !options.default_scheduling;
    ShellPath path;
    return run_and_print(settings, path, options.json);
}

int run(const ShellOptions& options, std::vector<std::vector<std::string>> commands) {
    ShellSettings settings;
    settings.commands = std::move(commands);
    Network network = read_network(options.network);
    settings.links = std::move(network.links);
    settings.timelines = std::move(network.timelines);
    settings.seed = network.seed;
    settings.precise = options.precise;
    settings.runtime.realtime_scheduling = !options.default_scheduling;
    settings.log = options.log;
    settings.control = options.control;
    const ShellResult result = run_shell(settings);
    if (options.json) {
        fmt::print("{}\n", json_text(result.report, 2));
    } else {
        fmt::print(stderr, "{}", report_text(result.report));
    }
    if (!result.log_fault.empty()) spdlog::error(result.log_fault);
    const bool incomplete = result.exit_code == 0 && !result.log_fault.empty();
    return incomplete ? static_cast<int>(ExitCode::kData) : result.exit_code;
}

std::shared_ptr<ShellOptions> options_of(CLI::App& command, const char* up, const char* down) {
    auto o = std::make_shared<ShellOptions>();
    add_network_options(command, o->network);
    command.add_option("--uplink", o->network.uplink, fmt::format("tc's words for {}", up))
        ->type_name("WORDS");
    command.add_option("--downlink", o->network.downlink, fmt::format("tc's words for {}", down))
        ->type_name("WORDS");
    command.add_flag(
        "--precise", o->precise,
        "busy-wait before each send: microseconds of error instead of tens, at the cost of processor time");
    command.add_flag("--default-scheduling", o->default_scheduling, "do not ask for real-time scheduling");
    command.add_option("--log", o->log, "write the fate of each packet; as text if the name ends in .csv")
        ->type_name("FILE");
    command.add_option("--control", o->control, "make a socket for the commands set, show and watch")
        ->type_name("PATH");
    command.add_flag("--json", o->json, "print the summary as JSON on stdout, instead of text on stderr");
    return o;
}

}  // namespace

NetemCommand add_shell(CLI::App& app, const std::vector<std::string>& programs) {
    CLI::App* command = app.add_subcommand(
        "shell", "run a program, or your shell, behind an emulated network: -- PROGRAM [ARGUMENT...]");
    const auto options = options_of(*command, "packets that the program sends", "packets that it receives");
    CLI::Option* tests_itself = command->add_flag(
        "--selftest", options->selftest,
        "run no program: send test traffic and report whether this machine is accurate enough");
    tests_itself->excludes("--log")->excludes("--control");
    command->add_option("--seconds", options->seconds, "duration of --selftest, s (default 10)")
        ->check(CLI::Range(0.1, 86400.0))
        ->needs(tests_itself);
    return {command, [options, programs] {
                auto commands = split_commands(programs);
                if (options->selftest && !commands.empty())
                    throw Error(ExitCode::kUsage,
                                "shell: --selftest makes its own traffic: leave out '--' and the program");
                if (options->selftest) return selftest(*options);
                if (commands.empty()) {
                    const char* shell = std::getenv("SHELL");
                    commands = {{shell != nullptr ? shell : "/bin/sh"}};
                }
                if (commands.size() > 1 || commands[0].empty())
                    throw Error(ExitCode::kUsage,
                                "shell: write one program after '--', or none for your shell");
                return run(*options, commands);
            }};
}

NetemCommand add_pair(CLI::App& app, const std::vector<std::string>& programs) {
    CLI::App* command = app.add_subcommand(
        "pair", "run two programs with an emulated network between them: -- PROGRAM... -- PROGRAM...");
    const auto options =
        options_of(*command, "packets that the first program sends", "packets that the second program sends");
    return {command, [options, programs] {
                const auto commands = split_commands(programs);
                if (commands.size() != 2 || commands[0].empty() || commands[1].empty())
                    throw Error(ExitCode::kUsage, "pair: write two programs: thimble-netem pair -- A -- B");
                return run(*options, commands);
            }};
}

}  // namespace thimble
