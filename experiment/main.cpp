// thimble: launches and steers the nodes, runs studies, writes reports.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/version.hpp"
#include "experiment/combined_report.hpp"
#include "experiment/condition_summary.hpp"
#include "experiment/headline.hpp"
#include "experiment/replay.hpp"
#include "experiment/run.hpp"
#include "experiment/seed_sweep.hpp"
#include "experiment/study.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace {

using namespace thimble;

struct Arguments {
    std::string config, out, run_folder, study_folder;
    ReplayOptions replay;
    std::string experiment = "3", order;
    std::string table, claims_out;
    std::uint32_t subjects = 0, seeds = 1;
    std::uint64_t seed = 1;
    unsigned jobs = 0;
    int base_port = 0;
    bool overwrite = false, resume = false, json = false, trajectories = false, no_control = false,
         strict_rt = false, attach = false;
    std::string command;
};

// The nodes' programs lie beside this one.
std::filesystem::path program_folder() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path("/usr/bin") : self.parent_path();
}

std::string number_text(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", value); }

void say_condition(std::uint32_t experiment, const ConditionSummary& c) {
    const Statistic& displacement = c.of(Metric::kPeakDisplacement);
    fmt::print(
        "experiment {} {:>6} {:<4} {:3} trials, {:3} oscillate, maximum penetration {:>6} mm, completion "
        "{:>5} "
        "s{}\n",
        experiment, delay_text(c.delay_s), to_string(c.modality), c.trials, c.oscillating,
        number_text(1000 * c.of(Metric::kPenetrationMax).mean),
        number_text(c.of(Metric::kCompletionTime).mean),
        displacement.n > 0 ? fmt::format(", peak displacement {} mm", number_text(1000 * displacement.mean))
                           : "");
}

void say_results(const Arguments& arguments, const std::filesystem::path& folder,
                 const std::vector<TrialRow>& rows) {
    if (arguments.json) {
        std::ifstream summary(folder / "summary.json");
        std::cout << summary.rdbuf();
        return;
    }
    for (const std::uint32_t experiment : {1U, 2U, 3U}) {
        std::vector<TrialRow> own;
        std::copy_if(rows.begin(), rows.end(), std::back_inserter(own),
                     [&](const TrialRow& row) { return row.conditions.experiment == experiment; });
        for (const ConditionSummary& c : summarize(own)) say_condition(experiment, c);
    }
    const auto delayed = [](const TrialRow& row) { return row.conditions.delay_s > 0; };
    if (std::any_of(rows.begin(), rows.end(), delayed)) {
        fmt::print("{}\n", judge_headline(summarize(without_removals(rows))).sentence());
    }
    fmt::print("report: {}\n", (folder / "report.html").string());
}

std::vector<Protocol> protocols_of(const Arguments& a, const SystemSettings& settings) {
    const std::uint32_t without = a.subjects != 0 ? a.subjects : kSubjectsWithoutDelay;
    const std::uint32_t with = a.subjects != 0 ? a.subjects : kSubjectsWithDelay;
    const bool all = a.experiment == "all";
    std::vector<Protocol> protocols;
    if (all || a.experiment == "1") protocols.push_back(experiment_1(settings, without, a.seed));
    if (all || a.experiment == "2") protocols.push_back(experiment_2(settings, without, a.seed));
    if (all || a.experiment == "3") protocols.push_back(experiment_3(settings, with, a.seed));
    return protocols;
}

// What gives the same results, without where they went and how they came: a resumed study equals another.
std::string study_command(const Arguments& a) {
    std::string command = fmt::format("thimble study --experiment {} --seed {}", a.experiment, a.seed);
    if (a.subjects != 0) command += fmt::format(" --subjects {}", a.subjects);
    if (!a.order.empty()) command += " --order " + a.order;
    if (!a.config.empty()) command += " --config " + a.config;
    if (a.no_control) command += " --no-control";
    if (a.seeds > 1) command += fmt::format(" --seeds {}", a.seeds);
    return command;
}

int sweep_seeds(const Arguments& arguments, const SystemSettings& settings) {
    SweepOptions options;
    options.protocols = protocols_of(arguments, settings);
    options.seeds = arguments.seeds;
    options.out = arguments.out;
    options.command = study_command(arguments);
    options.jobs = arguments.jobs;
    if (arguments.overwrite) options.if_exists = IfExists::kReplace;
    options.stop = &stop_requested();
    const SweepResult result = run_sweep(settings, options);
    for (const ClaimCount& c : result.claims) {
        if (c.judged == 0) continue;
        fmt::print("{:>4.0f} % of {} seeds {:<18} {}\n", 100 * c.fraction(), c.judged, c.claim.id,
                   c.fragile() ? "fragile: " + c.claim.claim : c.claim.claim);
    }
    fmt::print("report: {}\n", (options.out / "report.html").string());
    if (!result.complete) spdlog::error("interrupted; the {} seeds that were done are kept", result.seeds);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

int command_analyse(const Arguments& arguments) {
    const std::filesystem::path given(arguments.table);
    const auto table = std::filesystem::is_directory(given) ? given / "trials.csv" : given;
    const std::vector<Claim> claims = judge_claims(read_trial_table(table));
    if (!arguments.claims_out.empty()) write_claims(claims, arguments.claims_out);
    for (const Claim& c : claims) {
        fmt::print("{:<12} {:<18} {}\n{:<12} paper: {}\n{:<12} here:  {}\n",
                   !c.reproduced   ? "not judged"
                   : *c.reproduced ? "reproduced"
                                   : "no",
                   c.id, c.claim, "", c.paper, "", c.ours);
    }
    fmt::print("{}\n", claims_sentence(claims));
    return 0;
}

int command_study(const Arguments& arguments) {
    SystemSettings settings = load_system_settings(arguments.config);
    if (!arguments.order.empty()) settings.plan.order = *parse_order(arguments.order);
    install_stop_signals();
    if (arguments.seeds > 1) return sweep_seeds(arguments, settings);
    StudyOptions options;
    options.protocols = protocols_of(arguments, settings);
    options.out = arguments.out;
    options.command = study_command(arguments);
    options.jobs = arguments.jobs;
    if (arguments.overwrite) options.if_exists = IfExists::kReplace;
    if (arguments.resume) options.if_exists = IfExists::kContinue;
    options.trajectories = arguments.trajectories;
    options.control = !arguments.no_control;
    options.stop = &stop_requested();
    const StudyResult result = run_study(settings, options);
    if (result.resumed > 0) spdlog::info("{} trials were there already", result.resumed);
    spdlog::info("{:.0f} s simulated in {:.2f} s: {:.0f} x real time", result.simulated_s, result.wall_s,
                 result.simulated_s / result.wall_s);
    if (!arguments.json) fmt::print("{}\n", claims_sentence(result.claims));
    say_results(arguments, options.out, result.rows);
    if (!result.complete)
        spdlog::error("interrupted; the {} trials that had ended are kept: go on with --resume",
                      result.rows.size());
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

int command_run(const Arguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    install_stop_signals();
    const ConfigFile file =
        arguments.config.empty() ? ConfigFile::empty() : ConfigFile::load(arguments.config);
    RunOptions options;
    options.config = arguments.config;
    options.programs = program_folder();
    options.out = arguments.out;
    options.command = arguments.command;
    options.network = read_network_settings(file);
    options.runtime = read_runtime_settings(file);
    if (arguments.base_port != 0) options.network.base_port = static_cast<std::uint16_t>(arguments.base_port);
    options.overwrite = arguments.overwrite;
    options.strict_rt = arguments.strict_rt;
    options.attach = arguments.attach;
    options.stop = &stop_requested();
    const RunResult result = run_session(settings, options);
    say_results(arguments, options.out, result.rows);
    if (result.code != ExitCode::kOk) spdlog::error(result.problem);
    return static_cast<int>(result.code);
}

int command_report(const Arguments& arguments) {
    write_combined_report(arguments.run_folder, arguments.study_folder, arguments.out, arguments.command);
    fmt::print("report: {}\n", arguments.out);
    return 0;
}

int command_check(const Arguments& arguments) {
    load_system_settings(arguments.config);
    fmt::print("{}: good\n", arguments.config);
    return 0;
}

int command_replay(Arguments& arguments) {
    install_stop_signals();
    arguments.replay.stop = &stop_requested();
    const ReplayOptions& options = arguments.replay;
    const ReplayResult result = replay(options);
    if (arguments.json) {
        const nlohmann::ordered_json summary{
            {"scene", options.scene.string()},   {"solver", options.solver},
            {"samples", result.samples},         {"duration_s", result.duration_s},
            {"transitions", result.transitions}, {"force_peak_N", result.force_peak_N},
            {"out", options.out.string()},       {"events", result.events.string()},
            {"complete", result.complete}};
        fmt::print("{}\n", summary.dump(2));
    } else {
        fmt::print(
            "{} samples over {:g} s, {} transitions, greatest force {:.4g} N\nforces: {}\nevents: {}\n",
            result.samples, result.duration_s, result.transitions, result.force_peak_N, options.out.string(),
            result.events.string());
    }
    if (!result.complete) spdlog::error("interrupted; the {} samples done are kept", result.samples);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

void add_run(CLI::App& app, Arguments& a) {
    CLI::App* run =
        app.add_subcommand("run", "one trial per modality and delay, five real processes over UDP");
    run->add_option("session", a.config, "session file (TOML), e.g. deploy/sessions/delay50.toml")
        ->required();
    run->add_option("-o,--out", a.out, "folder for the results")->default_val("out/run");
    run->add_option("--base-port", a.base_port, "first UDP port, instead of [network].base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
    run->add_flag(
        "--attach", a.attach,
        "steer nodes that run already (on one machine or several, see [network]) instead of starting five; "
        "their own session file sets the delay");
    run->add_flag("--overwrite", a.overwrite, "replace earlier results in that folder");
    run->add_flag("--strict-rt", a.strict_rt, "exit with 4 if a node missed too many deadlines");
    run->add_flag("--json", a.json, "print summary.json on stdout");
    run->footer("Example:\n  thimble run deploy/sessions/delay50.toml --out out/run");
}

void add_study(CLI::App& app, Arguments& a) {
    CLI::App* study = app.add_subcommand("study", "the paper's experiments in virtual time");
    study
        ->add_option(
            "-e,--experiment", a.experiment,
            "1: no delay; 2: the fixture vanishes after 5 s of contact; 3: 50 ms on the force path; or all")
        ->default_val("3")
        ->check(CLI::IsMember({"1", "2", "3", "all"}));
    study->add_option("-n,--subjects", a.subjects, "virtual subjects (default: 16, in experiment 3 10)")
        ->check(CLI::Range(1, 100000));
    study->add_option("--order", a.order, "of trials: shuffled, as in the paper, or williams (balanced)")
        ->check(CLI::IsMember({"shuffled", "williams"}));
    study->add_option("-s,--seed", a.seed, "the same seed gives the same bytes")->default_val(1);
    study
        ->add_option(
            "--seeds", a.seeds,
            "the whole study with that many seeds, from --seed on: how often does each claim come out?")
        ->default_val(1)
        ->check(CLI::Range(1, 1000000));
    study->add_option("-c,--config", a.config, "session file (TOML); without it the paper's defaults");
    study->add_option("-o,--out", a.out, "folder for the results")->default_val("out/study");
    study->add_option("-j,--jobs", a.jobs, "threads, 0: one per core; the results do not depend on it")
        ->check(CLI::Range(0, 1024));
    study->add_flag("--no-control", a.no_control, "leave out the same trials without delay (control.csv)");
    study->add_flag("--trajectories", a.trajectories, "keep every trial's trajectory as CSV");
    CLI::Option* overwrite =
        study->add_flag("--overwrite", a.overwrite, "replace earlier results in that folder");
    study
        ->add_flag("--resume", a.resume,
                   "go on where an interrupted study of the same settings ended; the same bytes come out")
        ->excludes(overwrite);
    study->add_flag("--json", a.json, "print summary.json on stdout");
    study->footer(
        "Examples:\n  thimble study --experiment all --seed 1 --out out/study\n"
        "  thimble study --experiment all --seeds 100 --out out/seeds\n"
        "  thimble study --experiment 3 --subjects 40 --order williams --out out/large\n"
        "  thimble study --experiment 3 --subjects 40 --order williams --out out/large --resume");
}

void add_replay(CLI::App& app, Arguments& a) {
    ReplayOptions& r = a.replay;
    std::vector<std::string> solvers(kSolverNames.begin(), kSolverNames.end());
    CLI::App* sub = app.add_subcommand("replay", "a recorded or synthetic needle through a scene, offline");
    sub->add_option("--scene", r.scene, "scene file (TOML), or one that comes with the program")
        ->default_val(kPaperScene);
    sub->add_option("--needle", r.needle, "CSV with columns time_s and position_needle_m")->required();
    sub->add_option("-o,--out", r.out, "forces and surface, a line per sample; replaced if it exists")
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
    sub->add_flag("--json", a.json, "print a summary as JSON on stdout");
    std::string scenes;
    for (const BuiltInScene& scene : built_in_scenes()) scenes += fmt::format(" {}", scene.name);
    sub->footer(
        fmt::format("Scenes that come with the program:{}\n"
                    "Example:\n  thimble replay --scene paper.toml --needle needle.csv --out forces.csv",
                    scenes));
}

void add_others(CLI::App& app, Arguments& a) {
    CLI::App* report = app.add_subcommand("report", "one report.html from a run, a study, or both");
    report->add_option("--run", a.run_folder, "folder of a thimble run");
    report->add_option("--study", a.study_folder, "folder of a thimble study");
    report->add_option("-o,--out", a.out, "the report, replaced if it exists")
        ->default_val("out/report.html");
    report->footer("Example:\n  thimble report --run out/run --study out/study --out out/report.html");
    CLI::App* analyse =
        app.add_subcommand("analyse", "the paper's claims on a table of trials, by its tests");
    analyse->add_option("table", a.table, "a trials.csv, or a folder that holds one")->required();
    analyse->add_option("-o,--out", a.claims_out, "claims as JSON");
    analyse->footer("Example:\n  thimble analyse out/study --out claims.json");
    CLI::App* check = app.add_subcommand("check", "read a session file and say what is wrong with it");
    check->add_option("session", a.config, "session file (TOML)")->required();
    check->footer("Example:\n  thimble check deploy/sessions/delay50.toml");
}

int run_thimble(int argc, char** argv) {
    Arguments arguments;
    for (int i = 0; i < argc; ++i) arguments.command += (i > 0 ? " " : "") + std::string(argv[i]);
    CLI::App app("Teleoperation by touch: needle insertion with sensory subtraction, under network delay.",
                 "thimble");
    app.set_version_flag("--version", std::string(kVersion));
    app.require_subcommand(1);
    app.footer(
        "Example:\n  thimble run deploy/sessions/delay50.toml --out out/run\n\n"
        "Exit codes: 0 ok, 1 failed or interrupted, 2 usage or configuration, 3 network, 4 real time, 5 "
        "data.");
    add_run(app, arguments);
    add_study(app, arguments);
    add_replay(app, arguments);
    add_others(app, arguments);
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    if (app.got_subcommand("run")) return command_run(arguments);
    if (app.got_subcommand("study")) return command_study(arguments);
    if (app.got_subcommand("replay")) return command_replay(arguments);
    if (app.got_subcommand("report")) return command_report(arguments);
    if (app.got_subcommand("analyse")) return command_analyse(arguments);
    return command_check(arguments);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble", [&] { return run_thimble(argc, argv); });
}
