// thimble fit: which virtual operator moves as this participant does.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "analysis/report/report.hpp"
#include "analysis/text/html.hpp"
#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/fit/fit.hpp"
#include "study/ranks/ranks.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct FitArguments {
    std::string session;
    FitOptions fit;
};

// As typed, else as the study in the folder says.
std::filesystem::path session_of(const FitArguments& a) {
    if (!a.session.empty()) return find_session_file(a.session);
    const auto design = design_in(a.fit.folder);
    // Several of the paper's sessions differ in nothing but their trials.
    for (const std::string_view name : kPaperSessions)
        if (design && design->find(name) != std::string::npos) return find_session_file(std::string(name));
    throw Error(ExitCode::kUsage,
                "{}: cannot find out which session this folder is of: name it with --session, or check the "
                "name of the folder",
                a.fit.folder.string());
}

void say(const FitResult& result) {
    ReportTable table{
        "The operator of this participant",
        "From, to: 90 % interval. Narrowed: by how much these trials reduce the spread of the population.",
        {"key", "median", "from", "to", "narrowed"}};
    for (const KeySummary& key : result.keys)
        table.rows.push_back(
            {key.key, fmt::format("{:.3g}", key.median), fmt::format("{:.3g}", key.low),
             fmt::format("{:.3g}", key.high),
             key.identifiable() ? fmt::format("{:.0f} %", 100 * key.narrowed) : "not identifiable"});
    fmt::print("{}", plain_table(table));
    fmt::print(
        "Test: the fit predicts the last trial of each condition from the other trials. {} of {} features "
        "lie in their predicted 90 % interval.\n",
        result.held_out_inside, result.held_out);
}

int fit_participant(FitArguments a) {
    const SystemSettings settings = simulated_settings(load_system_settings(session_of(a)));
    install_stop_signals();
    a.fit.stop = &stop_requested();
    a.fit.out = join_ranks(a.fit.out);
    const FitResult result = run_fit(settings, a.fit);
    if (!result.complete) {
        spdlog::error("interrupted: the finished trials are saved; continue with --resume");
        return static_cast<int>(ExitCode::kRunFailed);
    }
    if (result.left_out > 0)
        spdlog::warn(
            "the fit leaves out {} trials: they did not reach the beep, or lack a phase that the fit needs",
            result.left_out);
    say(result);
    fmt::print("results: {}\n", (a.fit.out / "fit.json").string());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

Subcommand add_fit(CLI::App& app) {
    const auto arguments = std::make_shared<FitArguments>();
    FitArguments& a = *arguments;
    CLI::App* fit = app.add_subcommand("fit", "fit the virtual operator to the movements of one participant");
    fit->add_option("folder", a.fit.folder, "folder of a study or a run, with trials.csv and trajectories/")
        ->type_name("FOLDER")
        ->required();
    fit->add_option("--subject", a.fit.subject, "number of the participant in trials.csv")
        ->default_val(1)
        ->check(CLI::Range(1, 1000000));
    fit->add_option("-e,--experiment", a.fit.experiment,
                    "use only the trials of this experiment; needed if trials.csv holds several")
        ->check(CLI::Range(1, 3));
    fit->add_option(
           "--session", a.session,
           "session: a TOML file, or one that comes with the program; needed if the folder is not of "
           "the paper's sessions. Its [operator] describes the population, its other tables the "
           "participant's devices and network")
        ->type_name("FILE|NAME");
    fit->add_option("-o,--out", a.fit.out, "folder for fit.json, posterior.csv and simulations.csv")
        ->default_val("out/fit")
        ->type_name("FOLDER");
    fit->add_option("--simulations", a.fit.simulations,
                    "number of trials to simulate; more give narrower intervals")
        ->default_val(4000)
        ->check(CLI::Range(800, 10000000));
    fit->add_option("-s,--seed", a.fit.seed, "seed of all random numbers; the same seed gives the same bytes")
        ->default_val(1);
    add_jobs_option(*fit, a.fit.jobs);
    add_resume_options(*fit, a.fit.if_exists, "fit");
    fit->footer(
        "Examples:\n  thimble study --experiment 1 --trajectories --out out/study\n"
        "  thimble fit out/study --subject 3 --out out/fit\n"
        "  thimble study --experiment 3 --from out/fit --out out/twin\n"
        "Manual: docs/fit.md");
    return {fit, [arguments] { return fit_participant(*arguments); }, true};
}

}  // namespace thimble
