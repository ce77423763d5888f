// thimble study: a session's trials by virtual subjects in virtual time, once or over many seeds; by default the paper's.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "session/participant/dataset.hpp"
#include "study/fit/fit.hpp"
#include "study/power/power.hpp"
#include "study/ranks/ranks.hpp"
#include "study/study.hpp"
#include "study/sweeps/seed_sweep.hpp"
#include "study/with_compensator.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"
#include "thimble/commands/study_sweeps.hpp"

namespace thimble {
namespace {

struct StudyArguments {
    std::string session, out;
    std::string experiment, order, axis, from;
    std::vector<std::string> compensators;
    std::optional<std::uint32_t> subjects;
    std::optional<std::uint64_t> seed;
    std::uint32_t seeds = 1;
    unsigned jobs = 0;
    SweepRequest sweep;
    IfExists if_exists = IfExists::kRefuse;
    bool json = false, trajectories = false, no_control = false;
};

// The sessions' trials. One session, or all three of the paper, which differ in nothing but their trials.
struct StudyDesign {
    SystemSettings settings;
    std::vector<Protocol> protocols;
    bool paper = true;
    std::string words;  // of a command line that names it
    Provenance made_with{};
};

// A session's operator, rig and network, with the trials of the paper's experiments.
bool has_papers_trials(const StudyArguments& a) { return !a.session.empty() && !a.experiment.empty(); }

// Without a session --experiment N is the short form of the paper's sessions.
std::vector<std::filesystem::path> sessions_of(const StudyArguments& a) {
    if (!a.session.empty()) return {a.session};
    const std::string experiment = a.experiment.empty() ? "3" : a.experiment;
    std::vector<std::filesystem::path> files;
    for (const std::string_view name : kPaperSessions) {
        if (experiment == "all" || name.ends_with(experiment))
            files.push_back(find_session_file(std::string(name)));
    }
    return files;
}

SystemSettings settings_of(const std::filesystem::path& file, const StudyArguments& a) {
    SystemSettings settings =
        load_system_settings(file, a.from.empty() ? std::vector<SettingChange>{} : twin_of(a.from));
    require_virtual_subjects(settings, "study");
    if (!a.order.empty()) settings.plan.order = *parse_order(a.order);
    if (a.seed) settings.plan.seed = *a.seed;
    if (!a.subjects || has_papers_trials(a)) return settings;
    if (!settings.protocol) settings.protocol.emplace();
    settings.protocol->subjects = *a.subjects;
    return settings;
}

OtherValues other_values(const StudyArguments& a) {
    OtherValues other;
    if (!a.from.empty()) {
        other.fit = a.from;
        other.changes = twin_of(a.from);
    }
    if (a.seed) other.options.emplace_back("session.seed", std::to_string(*a.seed));
    if (!a.order.empty()) other.options.emplace_back("session.order", fmt::format("\"{}\"", a.order));
    if (a.subjects) other.options.emplace_back("protocol.subjects", std::to_string(*a.subjects));
    return other;
}

std::vector<Protocol> papers_protocols(const SystemSettings& settings, const StudyArguments& a) {
    if (settings.protocol || settings.plan.names_delays || settings.plan.names_modalities)
        throw Error(ExitCode::kUsage,
                    fmt::format("{}: the session plans its own trials, but --experiment {} asks for others: "
                                "leave out --experiment, or [protocol], delays and modalities of the file",
                                a.session, a.experiment));
    constexpr std::array kExperiments{experiment_1, experiment_2, experiment_3};
    std::vector<Protocol> protocols;
    for (std::size_t i = 0; i < kExperiments.size(); ++i) {
        if (a.experiment != "all" && a.experiment != std::to_string(i + 1)) continue;
        const std::uint32_t papers = i == 2 ? kSubjectsWithDelay : kSubjectsWithoutDelay;
        protocols.push_back(kExperiments.at(i)(settings, a.subjects.value_or(papers), settings.plan.seed));
    }
    return protocols;
}

StudyDesign design_of(const StudyArguments& a) {
    const std::vector<std::filesystem::path> files = sessions_of(a);
    StudyDesign design;
    for (const std::filesystem::path& file : files) {
        design.settings = settings_of(file, a);
        // A twin is one person: the paper's claims are about a population.
        design.paper = design.paper && a.from.empty() && (has_papers_trials(a) || is_paper_session(file));
        for (Protocol& protocol :
             has_papers_trials(a) ? papers_protocols(design.settings, a) : session_protocols(design.settings))
            design.protocols.push_back(std::move(protocol));
    }
    design.made_with = made_with(files, other_values(a));
    design.words = files.size() > 1 ? "--experiment all" : shipped_name(files[0]).value_or(files[0].string());
    if (has_papers_trials(a)) design.words += " --experiment " + a.experiment;
    return design;
}

void require_force_feedback(const StudyArguments& a, const std::vector<Protocol>& protocols) {
    const bool there = std::any_of(protocols.begin(), protocols.end(), [](const Protocol& protocol) {
        return std::count(protocol.modalities.begin(), protocol.modalities.end(), Modality::kHF) > 0;
    });
    if (there || a.compensators.empty()) return;
    throw Error(ExitCode::kUsage,
                "--compensators: delay compensators act in HF, but {} has no trials with HF: add \"HF\" to "
                "[session] modalities, or leave --compensators out",
                a.session);
}

// Each once, and none that HF has already: it would be the same condition twice.
std::vector<Compensator> compensators_of(const StudyArguments& a, const SystemSettings& settings) {
    std::vector<Compensator> compensators;
    compensators.reserve(a.compensators.size());
    for (const std::string& name : a.compensators) {
        const Compensator compensator = parse_compensator(name);
        if (settings.master.control.compensator == compensator)
            throw Error(
                ExitCode::kUsage,
                fmt::format(
                    "--compensators {}: HF has this compensator already ([control] of {}): leave it out",
                    name, a.session));
        if (std::find(compensators.begin(), compensators.end(), compensator) != compensators.end())
            throw Error(ExitCode::kUsage,
                        fmt::format("--compensators: {} is given twice: leave one out", name));
        control_for(settings, compensator);  // an Error for a plug-in that the session does not name
        compensators.push_back(compensator);
    }
    return compensators;
}

// The command that gives the same results, without output folder and way of running: a resumed study equals another.
std::string study_command(const StudyArguments& a, const StudyDesign& design) {
    std::string command = fmt::format("thimble study {} --seed {}", design.words, design.protocols[0].seed);
    if (a.subjects) command += fmt::format(" --subjects {}", *a.subjects);
    if (!a.order.empty()) command += " --order " + a.order;
    if (!a.from.empty()) command += " --from " + a.from;
    if (a.no_control) command += " --no-control";
    if (a.axis != kCurveAxisNames[0]) command += " --axis " + a.axis;
    if (!a.compensators.empty()) command += fmt::format(" --compensators {}", fmt::join(a.compensators, ","));
    if (a.seeds > 1) command += fmt::format(" --seeds {}", a.seeds);
    for (const std::string& range : a.sweep.vary) command += " --vary " + range;
    if (a.sweep.draws > 0) command += fmt::format(" --draws {}", a.sweep.draws);
    return command;
}

// Many studies keep the paper's claims and nothing else. These need the paper's trials; other parameters are what may be asked about.
void require_paper_trials(const std::vector<Protocol>& protocols) {
    if (std::all_of(protocols.begin(), protocols.end(), plans_paper_trials)) return;
    throw Error(ExitCode::kUsage,
                "--seeds, --vary and --draws count how often the paper's claims are reproduced, but the "
                "delays, modalities or numbers of trials of this session are not the paper's: leave these "
                "options out, or copy [session] and [protocol] from a session paper-experiment-N");
}

// Options of one study and of many.
template <class Options>
Options options_of(const StudyArguments& arguments, const StudyDesign& design) {
    Options options;
    options.protocols = design.protocols;
    options.out = arguments.out;
    options.command = study_command(arguments, design);
    options.made_with = design.made_with;
    options.jobs = arguments.jobs;
    options.if_exists = arguments.if_exists;
    options.stop = &stop_requested();
    return options;
}

SweepOptions sweep_options(const StudyArguments& arguments, const StudyDesign& design) {
    require_paper_trials(design.protocols);
    auto options = options_of<SweepOptions>(arguments, design);
    options.seeds = arguments.seeds;
    return options;
}

// The fit's values, which no session file has: --resume needs the same.
std::string fit_text(const std::vector<SettingChange>& twin) {
    std::string plan;
    for (const SettingChange& change : twin) plan += fmt::format("fit: {} = {}\n", change.key, change.value);
    return plan;
}

StudyOptions study_options(const StudyArguments& arguments, const StudyDesign& design) {
    auto options = options_of<StudyOptions>(arguments, design);
    options.paper_design = design.paper;
    options.trajectories = arguments.trajectories;
    if (arguments.axis != kCurveAxisNames[0]) options.curves = kPercentGrid;
    // A user's session names its delays itself.
    options.control = design.paper && !arguments.no_control;
    require_force_feedback(arguments, design.protocols);
    options.compensators = compensators_of(arguments, design.settings);
    if (!arguments.from.empty()) {
        options.plan = fit_text(twin_of(arguments.from));
        options.person = {bounds_table(delay_bounds(design.settings, arguments.from))};
    }
    return options;
}

int run_one_study(StudyArguments arguments) {
    const bool many = arguments.sweep.asked() || arguments.seeds > 1;
    if (!many && own_rank() > 0) return 0;  // whole trials are too large to be sent about
    if (many) arguments.out = join_ranks(arguments.out).string();
    const StudyDesign design = design_of(arguments);
    refuse_dataset(arguments.out);
    install_stop_signals();
    if (arguments.sweep.asked()) {
        return sweep_parameters(design.settings.file, arguments.sweep, sweep_options(arguments, design));
    }
    if (arguments.seeds > 1) return sweep_seeds(design.settings, sweep_options(arguments, design));
    const StudyOptions options = study_options(arguments, design);
    refuse_other_report(options.out / "trials.csv", options.if_exists);
    const StudyResult result = run_study(design.settings, options);
    if (result.resumed > 0) spdlog::info("{} trials were already done", result.resumed);
    spdlog::info("simulated {:.0f} s in {:.2f} s: {:.0f} x real time", result.simulated_s, result.wall_s,
                 result.simulated_s / result.wall_s);
    if (!arguments.json && !result.claims.empty()) fmt::print("{}.\n", claims_sentence(result.claims));
    if (!arguments.json && !options.person.empty()) fmt::print("{}", plain_table(options.person[0]));
    say_results(arguments.json, options.out, result.rows);
    if (!result.complete)
        spdlog::error("interrupted: {} trials are done and saved; continue with --resume",
                      result.rows.size());
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

// Options that run many studies.
std::vector<CLI::Option*> add_sweeps(CLI::App* study, StudyArguments& a) {
    CLI::Option* seeds =
        study
            ->add_option(
                "--seeds", a.seeds,
                "run the whole study with this many seeds, from --seed on, and count how often each claim of "
                "the paper is reproduced")
            ->default_val(1)
            ->check(CLI::Range(1, 1000000));
    CLI::Option* vary =
        study
            ->add_option("--vary", a.sweep.vary,
                         "vary a parameter of the virtual operator or of a device from LOW to HIGH in POINTS "
                         "steps. Each step runs --seeds studies and counts how often each claim of the paper "
                         "is reproduced. May be given several times: each parameter varies alone")
            ->type_name("NAME=LOW:HIGH:POINTS")
            ->allow_extra_args(false);
    CLI::Option* draws =
        study
            ->add_option("--draws", a.sweep.draws,
                         "run this many studies. Each draws all uncertain parameters at random from their "
                         "ranges, or from those of --vary NAME=LOW:HIGH")
            ->check(CLI::Range(1, 1000000))
            ->excludes(seeds);
    return {seeds, vary, draws};
}

// Options of a single study; of many studies only the claims are kept.
void add_single(CLI::App* study, StudyArguments& a, const std::vector<CLI::Option*>& sweeps) {
    CLI::Option* no_control = study->add_flag(
        "--no-control", a.no_control,
        "leave out the comparison trials of the paper's sessions: without delay (control.csv) and without "
        "the actuators' lag (no_lag.csv)");
    CLI::Option* compensators =
        study
            ->add_option("--compensators", a.compensators,
                         "also run the HF trials with each of these delay compensators, e.g. "
                         "wave,energy-bound (docs/compensators.md), compare them with HF, and write "
                         "hf_NAME.csv")
            ->delimiter(',')
            ->type_name("NAME,...");
    CLI::Option* trajectories =
        study->add_flag("--trajectories", a.trajectories, "save the trajectory of every trial as CSV");
    CLI::Option* axis =
        study
            ->add_option("--axis", a.axis,
                         "time axis of the figure of mean trajectories. contact: seconds from the first "
                         "contact with the fixture, as in the paper; percent: percent of the time from "
                         "tissue entry to the beep")
            ->default_val(kCurveAxisNames[0])
            ->check(CLI::IsMember({std::string(kCurveAxisNames[0]), std::string(kCurveAxisNames[1])}));
    CLI::Option* resume = add_resume_options(*study, a.if_exists, "study");
    CLI::Option* json = study->add_flag("--json", a.json, "print summary.json on stdout, instead of text");
    CLI::Option* from = study->get_option("--from");
    for (CLI::Option* of_one_study : {from, no_control, compensators, trajectories, axis, resume, json}) {
        for (CLI::Option* of_many : sweeps) of_one_study->excludes(of_many);
    }
}

}  // namespace

Subcommand add_study(CLI::App& app) {
    const auto arguments = std::make_shared<StudyArguments>();
    StudyArguments& a = *arguments;
    CLI::App* study =
        app.add_subcommand("study", "run a session's trials with virtual subjects, in virtual time");
    add_session_option(*study, a.session,
                       "session: a TOML file, or one that comes with the program, e.g. paper-experiment-1, "
                       "-2 or -3 (default)");
    study
        ->add_option("-e,--experiment", a.experiment,
                     "trials of one experiment of the paper, or of all three. 1: no delay; 2: the fixture "
                     "vanishes after 5 s of contact; 3: 50 ms of delay on the force path. With a session "
                     "that plans no trials: these trials with its operator, devices and network")
        ->check(CLI::IsMember({"1", "2", "3", "all"}));
    study
        ->add_option("-n,--subjects", a.subjects,
                     "number of virtual subjects (default: [protocol] subjects, else 16, in experiment 3 10)")
        ->check(CLI::Range(1, 100000));
    study
        ->add_option("--order", a.order,
                     "order of the trials: shuffled, as in the paper, or williams, balanced (default: "
                     "[session] order)")
        ->check(CLI::IsMember({"shuffled", "williams"}));
    study
        ->add_option(
            "--from", a.from,
            "folder of thimble fit: each subject is the person of this fit, with new random numbers in each "
            "trial")
        ->type_name("FIT");
    as_session_seed(study->add_option(
        "-s,--seed", a.seed,
        "seed of all random numbers (default: [session] seed, else 1); the same seed gives the same "
        "bytes"));
    study->add_option("-o,--out", a.out, "folder for the results")
        ->default_val("out/study")
        ->type_name("FOLDER");
    add_jobs_option(*study, a.jobs);
    add_single(study, a, add_sweeps(study, a));
    study->footer(
        "Writes report.html with figures, the tables (trials.csv, ...) and summary.json to the folder of "
        "--out.\n"
        "Examples:\n  thimble study --experiment all --seed 1 --out out/study\n"
        "  thimble study --experiment all --seeds 100 --out out/seeds\n"
        "  thimble study calibrated-operator --experiment all --out out/calibrated\n"
        "  thimble study --vary handle.friction_N=0.3:1:8 --seeds 12 --out out/friction\n"
        "  thimble study --experiment all --draws 300 --out out/robust\n"
        "  thimble study paper-experiment-3 --compensators wave,energy-bound --out out/controllers\n"
        "  thimble study my-session.toml --subjects 40 --order williams --out out/large\n"
        "  thimble study my-session.toml --subjects 40 --order williams --out out/large --resume\n"
        "  thimble study --experiment 3 --from out/fit --subjects 1 --out out/twin\n"
        "Manual: docs/studies.md");
    return {study, [arguments] { return run_one_study(*arguments); }, true};
}

}  // namespace thimble
