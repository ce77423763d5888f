// thimble-netem: an emulated network. Alone in front of any UDP program, or as a node of a session.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/version.hpp"
#include "netem/commands/commands.hpp"

namespace {

using namespace thimble;

constexpr const char* kFooter =
    "Examples:\n"
    "  thimble-netem --listen 9000 --to 192.168.1.20:9001 --profile \"delay 50ms 5ms loss 1%\"\n"
    "  thimble-netem --listen 9000 --to robot:9001 --profile leo --precise --log packets.bin --control "
    "/tmp/netem\n"
    "  thimble-netem set --control /tmp/netem down.delay_s=0.1\n"
    "  thimble-netem --selftest --profile lte --precise\n"
    "  thimble-netem shell --profile lte -- ssh robot\n"
    "  thimble-netem pair --profile wifi -- ./robot.sh -- ./operator.sh\n"
    "\n"
    "Without --listen it is a program of a Thimble session: see thimble-netem node --help.\n"
    "Manual: docs/network-relay.md, docs/network-shell.md.\n"
    "Exit codes: 0 ok, 1 failed, 2 usage or configuration, 3 network, 4 real time, 5 data.";

// A session starts its node with options alone, none of them these. A person may name the session file first.
bool is_node_call(int argc, char** argv) {
    constexpr std::array<std::string_view, 17> kOwn{
        "--listen",     "--to",       "--selftest", "--print-tc",  "--help",  "-h",
        "--completion", "--complete", "--profile",  "-p",          "--link",  "--seed",
        "-s",           "--control",  "--metrics",  "--max-flows", "--idle-s"};
    if (argc < 2) return true;
    const std::string_view first(argv[1]);
    if (!first.starts_with('-')) return first == "node" || first.ends_with(".toml");
    return std::none_of(argv + 1, argv + argc, [&](std::string_view word) {
        return std::find(kOwn.begin(), kOwn.end(), word.substr(0, word.find('='))) != kOwn.end();
    });
}

// How many words are for this program: `shell` and `pair` have other programs, with words of their own, behind "--".
int own_words(int argc, char** argv) {
    const std::string_view first(argv[1]);
    if (first != "shell" && first != "pair") return argc;
    return static_cast<int>(std::find(argv, argv + argc, std::string_view("--")) - argv);
}

int run_stand_alone(int argc, char** argv) {
    CLI::App app(
        "Emulates a network between UDP programs: delay, jitter, loss and more. It measures its own error.",
        "thimble-netem");
    app.set_version_flag("--version", std::string(kVersion));
    app.require_subcommand(0, 1);
    app.footer(kFooter);
    const auto relay = add_relay(app);
    const int own = own_words(argc, argv);
    const std::vector<std::string> programs(argv + own, argv + argc);
    const std::array commands{add_import(app),
                              add_fit(app),
                              add_set(app),
                              add_show(app),
                              add_watch(app),
                              add_log(app),
                              add_shell(app, programs),
                              add_pair(app, programs)};
    if (const auto exit_code = parse_command_line(app, own, argv)) return *exit_code;
    const auto given = std::find_if(commands.begin(), commands.end(),
                                    [](const NetemCommand& command) { return command.subcommand->parsed(); });
    return given == commands.end() ? relay() : given->run();
}

}  // namespace

int main(int argc, char** argv) {
    if (is_node_call(argc, argv)) {
        const bool named = argc > 1 && std::string_view(argv[1]) == "node";
        return run_node(named ? argc - 1 : argc, named ? argv + 1 : argv);
    }
    return guarded_main("thimble-netem", [&] { return run_stand_alone(argc, argv); });
}
