// thimble-netem shell [-- PROGRAM]: all that a program says passes a link. thimble-netem pair -- A -- B: a link between two.
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "netem/commands/commands.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/profiles/profiles.hpp"
#include "netem/relay/control_text.hpp"
#include "netem/relay/relay_report.hpp"
#include "netem/shell/shell_service.hpp"

namespace thimble {
namespace {

struct ShellOptions {
    std::string profile, uplink, downlink, log, control;
    std::vector<std::string> link;
    std::optional<std::uint64_t> seed;  // without it that of tc's words, or 1
    bool precise = false, json = false, default_scheduling = false;
};

void take_words(LinkSettings& link, const std::string& words, std::uint64_t& seed) {
    if (words.empty()) return;
    TcWays read = parse_tc(words);
    if (read.one_way) read.notes.pop_back();  // which asks for `both`; the option has said the way
    for (const std::string& note : read.notes) spdlog::info(note);
    link = std::move(read.up == LinkSettings{} ? read.down : read.up);
    seed = read.seed.value_or(seed);
}

void read_links(const ShellOptions& options, ShellSettings& settings) {
    if (!options.profile.empty()) {
        LinkProfile profile = load_profile(options.profile);
        for (const std::string& note : profile.notes) spdlog::info(note);
        settings.links = {std::move(profile.up), std::move(profile.down)};
        settings.timelines = {std::move(profile.up_changes), std::move(profile.down_changes)};
        settings.seed = profile.seed.value_or(settings.seed);
    }
    take_words(settings.links.up, options.uplink, settings.seed);
    take_words(settings.links.down, options.downlink, settings.seed);
    settings.seed = options.seed.value_or(settings.seed);
    settings.links = assign(settings.links, options.link);
}

// The programs behind each "--".
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

int run(const ShellOptions& options, std::vector<std::vector<std::string>> commands) {
    ShellSettings settings;
    settings.commands = std::move(commands);
    read_links(options, settings);
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
    return result.exit_code;
}

std::shared_ptr<ShellOptions> options_of(CLI::App& command, const char* up, const char* down) {
    auto o = std::make_shared<ShellOptions>();
    command
        .add_option("-p,--profile", o->profile, "the network: a name, a TOML file, or tc's words in quotes")
        ->type_name("NAME|FILE|WORDS");
    command.add_option("--uplink", o->uplink, fmt::format("tc's words for {}", up))->type_name("WORDS");
    command.add_option("--downlink", o->downlink, fmt::format("tc's words for {}", down))->type_name("WORDS");
    command.add_option("--link", o->link, "single settings on top of it, e.g. up.delay_s=0.05 loss=0.01")
        ->type_name("KEY=VALUE");
    command.add_option("--seed", o->seed,
                       "the same seed gives each packet the same fate; 1, or that of tc's words");
    command.add_flag("--precise", o->precise,
                     "spin before due times: microseconds instead of tens, for some CPU");
    command.add_flag("--default-scheduling", o->default_scheduling, "do not ask for real-time scheduling");
    command.add_option("--log", o->log, "write what became of each packet; text if it ends in .csv")
        ->type_name("FILE");
    command.add_option("--control", o->control, "socket for set, show and watch")->type_name("PATH");
    command.add_flag("--json", o->json,
                     "summary as JSON on standard output instead of text on standard error");
    return o;
}

}  // namespace

NetemCommand add_shell(CLI::App& app, const std::vector<std::string>& programs) {
    CLI::App* command =
        app.add_subcommand("shell", "a program, or your shell, behind a link: -- PROGRAM [ARGUMENT...]");
    const auto options = options_of(*command, "what the program sends", "what comes back");
    return {command, [options, programs] {
                auto commands = split_commands(programs);
                if (commands.empty()) {
                    const char* shell = std::getenv("SHELL");
                    commands = {{shell != nullptr ? shell : "/bin/sh"}};
                }
                if (commands.size() > 1 || commands[0].empty())
                    throw Error(ExitCode::kUsage,
                                "shell: write one program behind '--', or none for your shell");
                return run(*options, commands);
            }};
}

NetemCommand add_pair(CLI::App& app, const std::vector<std::string>& programs) {
    CLI::App* command =
        app.add_subcommand("pair", "a link between two programs: -- PROGRAM... -- PROGRAM...");
    const auto options = options_of(*command, "what the first program sends", "what the second one sends");
    return {command, [options, programs] {
                const auto commands = split_commands(programs);
                if (commands.size() != 2 || commands[0].empty() || commands[1].empty())
                    throw Error(ExitCode::kUsage, "pair: write two programs: thimble-netem pair -- A -- B");
                return run(*options, commands);
            }};
}

}  // namespace thimble
