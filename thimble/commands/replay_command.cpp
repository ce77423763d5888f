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
            "{} samples over {:g} s, {} transitions, greatest force {:.4g} N\nforces: {}\nevents: {}\n",
            result.samples, result.duration_s, result.transitions, result.force_peak_N, options.out.string(),
            result.events.string());
    }
    if (!result.complete) spdlog::error("interrupted; the {} samples done are kept", result.samples);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

}  // namespace

Subcommand add_replay(CLI::App& app) {
    const auto arguments = std::make_shared<ReplayArguments>();
    ReplayOptions& r = arguments->options;
    std::vector<std::string> solvers(kSolverNames.begin(), kSolverNames.end());
    CLI::App* sub = app.add_subcommand("replay", "a recorded or synthetic needle through a scene, offline");
    sub->add_option("--scene", r.scene, "scene file (TOML), or one that comes with the program")
        ->default_val(kPaperScene);
    sub->add_option("--needle", r.needle, "CSV with columns time_s and position_needle_m")->required();
    sub->add_option("-o,--out", r.out,
                    "forces and surface, a line per sample, replaced if it exists: a file that ends in .csv, "
                    "or a folder for forces.csv")
        ->required();
    sub->add_option("--events", r.events, "transitions (default: OUT with .events.csv for .csv)");
    sub->add_option("--solver", r.solver, "how tissue is stepped")
        ->default_val(solvers.front())
        ->check(CLI::IsMember(solvers));
    sub->add_option("--solver-step-s", r.solver_step_s,
                    "longest step of a solver that steps; exact needs none")
        ->default_val(r.solver_step_s)
        ->check(CLI::Range(1e-9, 1e3));
    sub->add_option("--longest-gap-s", r.limits.longest_gap_s, "samples further apart are refused as a gap")
        ->default_val(r.limits.longest_gap_s)
        ->check(CLI::PositiveNumber);
    sub->add_flag("--json", arguments->json, "print a summary as JSON on stdout");
    std::string scenes;
    for (const BuiltInScene& scene : built_in_scenes()) scenes += fmt::format(" {}", scene.name);
    sub->footer(
        fmt::format("Scenes that come with the program:{}\n"
                    "Example:\n  thimble replay --scene paper.toml --needle needle.csv --out forces.csv",
                    scenes));
    return {sub, [arguments] { return run_replay(*arguments); }};
}

}  // namespace thimble
