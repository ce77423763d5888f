// thimble: launches and steers the nodes, runs studies, writes reports.
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/version.hpp"
#include "study/ranks/ranks.hpp"
#include "thimble/commands/commands.hpp"

namespace {

using namespace thimble;

struct Purpose {
    const char* title;
    std::vector<Subcommand> commands;
};

// In the order of --help.
std::vector<Purpose> add_commands(CLI::App& app, const std::string& typed) {
    std::vector<Purpose> purposes;
    purposes.push_back(
        {"Try it", {add_play(app), add_run(app, typed), add_stop(app), add_check(app), add_config(app)}});
    purposes.push_back({"Study",
                        {add_study(app), add_compensators(app), add_board(app), add_analyse(app),
                         add_report(app, typed), add_replay(app), add_power(app, typed)}});
    purposes.push_back({"People", {add_dataset(app), add_fit(app)}});
    purposes.push_back({"Network", {add_link_test(app), add_keygen(app)}});
    purposes.push_back({"Stability and safety", {add_stability(app), add_sweep(app), add_swarm(app)}});
    purposes.push_back({"Logs", {add_log(app)}});
    purposes.push_back({"Machines", {add_doctor(app), add_completion(app)}});
    for (const Purpose& purpose : purposes) {
        for (const Subcommand& command : purpose.commands) command.subcommand->group(purpose.title);
    }
    return purposes;
}

int run_thimble(int argc, char** argv) {
    std::string typed;
    for (int i = 0; i < argc; ++i) typed += (i > 0 ? " " : "") + std::string(argv[i]);
    CLI::App app(
        "Teleoperation with touch feedback: inserts a needle over a delayed network and shows the force in "
        "four ways.",
        "thimble");
    app.set_version_flag("--version", std::string(kVersion));
    app.require_subcommand(1);
    app.footer(
        "Examples:\n"
        "  thimble run delay50 --out out/run\n"
        "  thimble study paper-experiment-3 --out out/study\n"
        "  thimble help study\n"
        "\n"
        "Exit codes: 0 ok, 1 failed or interrupted, 2 usage or configuration, 3 network, 4 real time, 5 "
        "data.");
    const std::vector<Purpose> purposes = add_commands(app, typed);
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    for (const Purpose& purpose : purposes) {
        for (const Subcommand& command : purpose.commands) {
            if (!command.subcommand->parsed()) continue;
            return command.by_ranks || own_rank() == 0 ? command.run() : 0;
        }
    }
    return 0;  // never: the app requires one
}

}  // namespace

int main(int argc, char** argv) {
    quieten_other_ranks();
    return end_of_rank(guarded_main("thimble", [&] { return run_thimble(argc, argv); }));
}
