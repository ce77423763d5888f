// thimble sweep: a stability map measured in virtual time, with the boundary of the theory.
#include <memory>

#include <CLI/CLI.hpp>

#include "common/runtime/realtime_loop.hpp"
#include "study/maps/map_options.hpp"
#include "study/ranks/ranks.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
namespace {

int run_sweep(SweepArguments arguments) {
    const MapGrid grid = grid_of(arguments);
    install_stop_signals();
    arguments.out = join_ranks(arguments.out).string();
    return run_map(arguments, grid);
}

}  // namespace

Subcommand add_sweep(CLI::App& app) {
    const auto arguments = std::make_shared<SweepArguments>();
    CLI::App* command =
        app.add_subcommand("sweep", "map stability over delay and stiffness, measured and by theory");
    add_sweep_options(*command, *arguments);
    return {command, [arguments] { return run_sweep(*arguments); }, true};
}

}  // namespace thimble
