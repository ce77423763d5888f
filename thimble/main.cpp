// thimble: launches and steers the nodes, runs studies, writes reports.
#include <algorithm>
#include <array>
#include <string>

#include <CLI/CLI.hpp>

#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/version.hpp"
#include "thimble/commands/commands.hpp"

namespace {

using namespace thimble;

int run_thimble(int argc, char** argv) {
    std::string typed;
    for (int i = 0; i < argc; ++i) typed += (i > 0 ? " " : "") + std::string(argv[i]);
    CLI::App app("Teleoperation by touch: needle insertion with sensory subtraction, under network delay.",
                 "thimble");
    app.set_version_flag("--version", std::string(kVersion));
    app.require_subcommand(1);
    app.footer(
        "Example:\n  thimble run deploy/sessions/delay50.toml --out out/run\n\n"
        "Exit codes: 0 ok, 1 failed or interrupted, 2 usage or configuration, 3 network, 4 real time, 5 "
        "data.");
    const std::array commands{
        add_run(app, typed), add_study(app),     add_replay(app),    add_report(app, typed), add_analyse(app),
        add_exclude(app),    add_check(app),     add_link_test(app), add_up(app, typed),     add_play(app),
        add_doctor(app),     add_stability(app), add_sweep(app),     add_compensators(app),  add_log(app),
        add_stop(app),       add_keygen(app),    add_config(app),    add_completion(app),    add_bids(app)};
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    const auto given = std::find_if(commands.begin(), commands.end(),
                                    [](const Subcommand& command) { return command.subcommand->parsed(); });
    return given->run();  // there is one: the app requires it
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble", [&] { return run_thimble(argc, argv); });
}
