// thimble run: one trial per modality and delay, or a participant's session, by real processes over UDP.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "session/launch/node_starter.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/real_run.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct RunArguments : RealRunArguments {
    bool attach = false;
};

int run_here(const RunArguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    if (arguments.attach) return run_for_real(arguments, settings, nullptr);
    if (settings.launch.anywhere_else()) {
        throw Error(
            ExitCode::kUsage,
            "the session file's [launch] names other machines, and thimble run starts every node on this "
            "one: use thimble up, or say --attach if the nodes run already");
    }
    return run_for_real(arguments, settings,
                        std::make_shared<LocalStarter>(program_folder(), arguments.config));
}

}  // namespace

Subcommand add_run(CLI::App& app, const std::string& typed) {
    const auto arguments = std::make_shared<RunArguments>();
    arguments->run.command = typed;
    CLI::App* run = app.add_subcommand(
        "run",
        "one trial per modality and delay, or, with a [protocol], one participant's session: "
        "five real processes over UDP");
    add_real_run_options(*run, "out/run", *arguments);
    run->add_flag(
        "--attach", arguments->attach,
        "steer nodes that run already (on one machine or several, see [network]) instead of starting five; "
        "their own session file sets the delay");
    run->footer(
        "Examples:\n  thimble run deploy/sessions/delay50.toml --out out/run\n"
        "  thimble run deploy/sessions/mouse-study.toml --out out/study7 --consent --participant P07\n"
        "  thimble run deploy/sessions/human.toml --out out/study8 --attach --consent --participant P07 "
        "--age 31");
    return {run, [arguments] { return run_here(*arguments); }};
}

}  // namespace thimble
