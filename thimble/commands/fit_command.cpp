// thimble fit: which virtual operator moves as this participant does.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "analysis/report/report.hpp"
#include "analysis/text/html.hpp"
#include "common/error.hpp"
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
    bool overwrite = false, resume = false;
};

// As typed, else as the study in the folder says.
std::filesystem::path session_of(const FitArguments& a) {
    if (!a.session.empty()) return find_session_file(a.session);
    const auto design = design_in(a.fit.folder);
    // Several of the paper's sessions differ in nothing but their trials.
    for (const std::string_view name : kPaperSessions)
        if (design && design->find(name) != std::string::npos) return find_session_file(std::string(name));
    throw Error(ExitCode::kUsage,
                "{}: does not say which session it is of: name the session file with --session",
                a.fit.folder.string());
}

void say(const FitResult& result) {
    ReportTable table{"The operator of this participant",
                      "Interval: 90 %. Narrowed: by how much the trials reduce the spread of the population.",
                      {"key", "median", "from", "to", "narrowed"}};
    for (const KeySummary& key : result.keys)
        table.rows.push_back(
            {key.key, fmt::format("{:.3g}", key.median), fmt::format("{:.3g}", key.low),
             fmt::format("{:.3g}", key.high),
             key.identifiable() ? fmt::format("{:.0f} %", 100 * key.narrowed) : "not identifiable"});
    fmt::print("{}", plain_table(table));
    fmt::print(
        "The last trial of each condition, predicted from the others: {} of {} features lie in their "
        "90 % interval.\n",
        result.held_out_inside, result.held_out);
}

int fit_participant(FitArguments a) {
    const SystemSettings settings = simulated_settings(load_system_settings(session_of(a)));
    if (a.overwrite) a.fit.if_exists = IfExists::kReplace;
    if (a.resume) a.fit.if_exists = IfExists::kContinue;
    install_stop_signals();
    a.fit.stop = &stop_requested();
    a.fit.out = join_ranks(a.fit.out);
    const FitResult result = run_fit(settings, a.fit);
    if (!result.complete) {
        spdlog::error("interrupted; the trials that were simulated are kept: go on with --resume");
        return static_cast<int>(ExitCode::kRunFailed);
    }
    if (result.left_out > 0)
        spdlog::warn("{} trials are left out: without a beep, or without a part that a fit needs",
                     result.left_out);
    say(result);
    fmt::print("fit: {}\n", (a.fit.out / "fit.json").string());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

Subcommand add_fit(CLI::App& app) {
    const auto arguments = std::make_shared<FitArguments>();
    FitArguments& a = *arguments;
    CLI::App* fit = app.add_subcommand("fit", "the virtual operator that moves as one participant does");
    fit->add_option("folder", a.fit.folder, "of a study or a run: its trials.csv and its trajectories/")
        ->required();
    fit->add_option("-n,--subject", a.fit.subject, "the participant, as trials.csv numbers them")
        ->default_val(1)
        ->check(CLI::Range(1, 1000000));
    fit->add_option("--experiment", a.fit.experiment,
                    "trials of this experiment alone, where trials.csv holds several")
        ->check(CLI::Range(1, 3));
    fit->add_option("--session", a.session,
                    "session file or name, if the folder is none of the paper's experiments: its [operator] "
                    "is the population, its rig the participant's");
    fit->add_option("-o,--out", a.fit.out, "folder for fit.json, posterior.csv and simulations.csv")
        ->default_val("out/fit");
    fit->add_option("--simulations", a.fit.simulations, "trials to learn from; more make intervals narrower")
        ->default_val(4000)
        ->check(CLI::Range(800, 10000000));
    fit->add_option("-s,--seed", a.fit.seed, "of the simulated people; the same seed gives the same bytes")
        ->default_val(1);
    fit->add_option("-j,--jobs", a.fit.jobs, "threads, 0: one per core; the results do not depend on it")
        ->check(CLI::Range(0, 1024));
    CLI::Option* overwrite =
        fit->add_flag("--overwrite", a.overwrite, "replace an earlier fit in that folder");
    fit->add_flag("--resume", a.resume, "go on where an interrupted fit ended; the same bytes come out")
        ->excludes(overwrite);
    fit->footer(
        "Example:\n  thimble study --experiment 1 --trajectories --out out/study\n"
        "  thimble fit out/study --subject 3 --out out/fit\n"
        "  thimble study --experiment 3 --from out/fit --out out/twin\n"
        "docs/fit.md is the manual.");
    return {fit, [arguments] { return fit_participant(*arguments); }, true};
}

}  // namespace thimble
