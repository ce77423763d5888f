// thimble replay: a needle's path through a scene, offline.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/replay.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct ReplayArguments {
    ReplayOptions options;
    bool json = false;
};

int run_replay(ReplayArguments& arguments) {
    install_stop_signals();
    arguments.options.stop = &stop_requested();
    arguments.options.out = output_file(arguments.options.out, "forces.csv");
    const ReplayOptions& options = arguments.options;
    const ReplayResult result = replay(options);
    if (arguments.json) {
        const nlohmann::ordered_json summary{
            {"scene", options.scene.string()},   {"solver", options.solver},
            {"samples", result.samples},         {"duration_s", result.duration_s},
            {"transitions", result.transitions}, {"force_peak_N", result.force_peak_N},
            {"out", options.out.string()},       {"events", result.events.string()},
            {"complete", result.complete}};
        fmt::print("{}\n", json_text(summary, 2));
    } else {
        fmt::print(
            "{} samples over {:g} s, {} events, greatest force {:.4g} N\n"
            "events: {}\n"
            "results: {}\n",
            result.samples, result.duration_s, result.transitions, result.force_peak_N,
            result.events.string(), options.out.string());
    }
    if (!result.complete) spdlog::error("interrupted; the {} finished samples are kept", result.samples);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

}  // namespace

Subcommand add_replay(CLI::App& app) {
    const auto arguments = std::make_shared<ReplayArguments>();
    ReplayOptions& r = arguments->options;
    std::vector<std::string> solvers(kSolverNames.begin(), kSolverNames.end());
    CLI::App* sub = app.add_subcommand("replay", "compute the forces of a scene on a recorded needle");
    sub->add_option("--scene", r.scene, "scene file (TOML), or the name of a built-in one")
        ->type_name("FILE|NAME")
        ->default_val(kPaperScene);
    sub->add_option("--needle", r.needle,
                    "needle movement: a CSV file with the columns time_s and position_needle_m")
        ->type_name("FILE")
        ->required();
    sub->add_option("-o,--out", r.out,
                    "CSV file for forces and surface, one line per sample, or a folder for forces.csv; "
                    "replaced if it exists")
        ->type_name("FILE|FOLDER")
        ->required();
    sub->add_option(
           "--events", r.events,
           "CSV file for the events, such as punctures; default: --out with .events.csv instead of .csv")
        ->type_name("FILE");
    sub->add_option("--solver", r.solver, "method that computes the tissue")
        ->default_val(solvers.front())
        ->check(CLI::IsMember(solvers));
    sub->add_option("--solver-step-s", r.solver_step_s,
                    "longest time step of the solver, s; not used by exact")
        ->default_val(r.solver_step_s)
        ->check(CLI::Range(1e-9, 1e3));
    sub->add_option("--longest-gap-s", r.limits.longest_gap_s, "longest allowed gap between two samples, s")
        ->default_val(r.limits.longest_gap_s)
        ->check(CLI::PositiveNumber);
    sub->add_flag("--json", arguments->json, "print a summary as JSON on stdout, instead of text");
    std::string scenes;
    for (const BuiltInScene& scene : built_in_scenes()) scenes += fmt::format(" {}", scene.name);
    sub->footer(
        fmt::format("Built-in scenes:{}\n"
                    "Example:\n"
                    "  thimble replay --scene paper.toml --needle needle.csv --out forces.csv",
                    scenes));
    return {sub, [arguments] { return run_replay(*arguments); }};
}

}  // namespace thimble
