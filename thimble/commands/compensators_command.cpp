// thimble compensators: a session's trials with each delay compensator in HF, beside HF, CF, CCF and VF.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/compensators/compensator_report.hpp"
#include "study/compensators/compensator_table.hpp"
#include "study/planned_table.hpp"
#include "study/power/power.hpp"
#include "study/ranks/ranks.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct CompensatorsArguments {
    std::string session, out;
    std::vector<double> delays_s;
    std::vector<std::string> only;
    std::optional<std::uint32_t> subjects, trials;  // instead of the session's
    std::optional<std::uint64_t> seed;
    CompensatorStudyOptions study;  // as the session and the above have it
    IfExists if_exists = IfExists::kRefuse;
};

std::string cell(double value, int decimals) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

void print_rows(const std::vector<CompensatorRow>& rows) {
    fmt::print("{:<24}{:>22}{:>7}{:>7}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}{:>8}\n", "condition", "network", "done",
               "osc.", "p-p mm", "pen mm", "max mm", "time s", "K / true", "drift", "share");
    for (const CompensatorRow& row : rows) {
        fmt::print("{:<24}{:>22}{:>7}{:>7}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}{:>8}\n", row.name, row.network.name,
                   fmt::format("{}/{}", row.completed, row.trials),
                   fmt::format("{}/{}", row.oscillating, row.trials),
                   cell(1000 * row.oscillation_peak_to_peak_m, 2), cell(1000 * row.penetration_mean_m, 2),
                   cell(1000 * row.penetration_max_m, 2), cell(row.completion_time_s, 2),
                   cell(row.rendered_stiffness, 3), cell(1000 * row.drift_needle_m, 2), cell(row.share, 3));
    }
}

// The command that gives the same results, without the output folder.
std::string compensators_command(const CompensatorsArguments& a) {
    std::string command = "thimble compensators";
    if (!a.session.empty()) command += " " + shipped_name(a.session).value_or(a.session);
    command +=
        fmt::format(" --subjects {} --trials {} --seed {}", a.study.subjects, a.study.trials, a.study.seed);
    if (!a.delays_s.empty()) command += fmt::format(" --delays-s {}", fmt::join(a.delays_s, ","));
    if (!a.only.empty()) command += fmt::format(" --only {}", fmt::join(a.only, ","));
    return command;
}

// All trials of the plan, done now or before. False if it was stopped.
bool run_all(const SystemSettings& settings, const CompensatorsArguments& a,
             std::vector<CompensatorTrial>& trials) {
    std::optional<CompensatorTrialTable> table;
    if (!a.out.empty()) {
        const std::filesystem::path folder(a.out), file = folder / "compensator_trials.csv";
        refuse_other_report(file, a.if_exists);
        open_plan(file, folder / "compensators.txt", "comparison", compensator_plan(settings, a.study),
                  a.if_exists, {"compensators.csv", "compensators.json", "report.html", "summary.json"});
        table.emplace(file, chosen_conditions(settings, a.study.names), trials);
    }
    std::size_t done = table ? table->done() : 0;
    if (done > 0) spdlog::info("{} of {} trials were already done", done, trials.size());
    Progress progress;
    const auto take = [&](const CompensatorTrial& trial) {
        if (table) table->append(trial);
        ++done;
        progress.count(done, trials.size(), "trials", trial.network.name);
    };
    const bool complete = run_compensator_trials(settings, a.study, std::span(trials).subspan(done), take);
    progress.close();
    if (!complete && table)
        spdlog::error("interrupted: {} trials are done and saved; continue with --resume", done);
    return complete;
}

// As typed, else as the session says, else those of the comparison.
std::vector<CompensatorNetwork> networks_of(const SystemSettings& settings, const CompensatorsArguments& a) {
    std::vector<double> delays_s = a.delays_s;
    refuse_twice("--delays-s", delays_s);
    if (delays_s.empty() && settings.plan.names_delays)
        for (const Duration delay : settings.plan.delays) delays_s.push_back(to_seconds(delay));
    return delays_s.empty() ? standard_networks() : plain_networks(delays_s);
}

// A session that names its modalities has these and all compensators, which act in HF.
std::vector<std::string> conditions_of(const SystemSettings& settings, const CompensatorsArguments& a) {
    if (!a.only.empty() || !settings.plan.names_modalities) return a.only;
    std::vector<std::string> names;
    for (const Modality modality : settings.plan.modalities) names.emplace_back(to_string(modality));
    const bool plugin = settings.master.control.compensator == Compensator::kPlugin;
    names.insert(names.end(), kBuiltInCompensators.begin() + 1, kBuiltInCompensators.end());
    if (plugin) names.emplace_back(kCompensatorNames.back());
    return names;
}

CompensatorStudyOptions study_of(const SystemSettings& settings, const CompensatorsArguments& a) {
    CompensatorStudyOptions study = a.study;
    if (const auto& protocol = settings.protocol) {
        if (protocol->experiments != std::vector{3U})
            throw Error(ExitCode::kUsage,
                        "[protocol] experiments contains 1 or 2, but thimble compensators runs only "
                        "experiment 3: write [3], or leave the key out");
        study.subjects = protocol->subjects;
        study.trials = protocol->trials_per_modality;
    }
    study.subjects = a.subjects.value_or(study.subjects);
    study.trials = a.trials.value_or(study.trials);
    study.seed = a.seed.value_or(settings.plan.seed);
    study.networks = networks_of(settings, a);
    study.names = conditions_of(settings, a);
    // Refuses a network that the session cannot have before anything is written.
    for (const CompensatorNetwork& network : study.networks) over_network(settings, network);
    return study;
}

Provenance session_values(const CompensatorStudyOptions& study) {
    return {{"session.seed", std::to_string(study.seed)},
            {"protocol.subjects", std::to_string(study.subjects)},
            {"protocol.trials_per_modality", std::to_string(study.trials)}};
}

int compare_compensators(CompensatorsArguments arguments) {
    const SystemSettings settings = load_system_settings(arguments.session);
    require_virtual_subjects(settings, "compensators");
    install_stop_signals();
    arguments.out = join_ranks(arguments.out).string();
    arguments.study = study_of(settings, arguments);
    arguments.study.stop = &stop_requested();
    std::vector<CompensatorTrial> trials = plan_compensator_trials(settings, arguments.study);
    if (!run_all(settings, arguments, trials)) return static_cast<int>(ExitCode::kRunFailed);
    print_rows(condense(settings, arguments.study, trials));
    if (!arguments.out.empty()) {
        write_compensator_report(settings, arguments.study, trials, compensators_command(arguments),
                                 made_with({arguments.session}, {{}, {}, session_values(arguments.study)}),
                                 arguments.out);
        fmt::print("results: {}\n", (std::filesystem::path(arguments.out) / "report.html").string());
    }
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

Subcommand add_compensators(CLI::App& app) {
    const auto arguments = std::make_shared<CompensatorsArguments>();
    CompensatorsArguments& a = *arguments;
    CLI::App* sub = app.add_subcommand("compensators",
                                       "compare delay compensators with HF, CF, CCF and VF, in virtual time");
    add_session_option(*sub, a.session,
                       "session: a TOML file, or one that comes with the program. It gives network, delays, "
                       "modalities, and numbers of subjects and trials");
    sub->add_option("-o,--out", a.out,
                    "folder for report.html, figures/ and the tables; without it the command only prints a "
                    "table")
        ->type_name("FOLDER");
    sub->add_option("--delays-s", a.delays_s,
                    "one-way delays of the force path, s (default: the session's, else "
                    "0,0.01,0.025,0.05,0.1,0.2, and 0.05 with jitter and loss)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("S,...")
        ->check(CLI::Range(0.0, 10.0));
    sub->add_option("--only", a.only, "compare only these conditions, e.g. HF,CF,wave")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAME,...");
    sub->add_option("-n,--subjects", a.subjects,
                    "number of virtual subjects (default: [protocol] subjects, else 10)")
        ->check(CLI::Range(1, 10000));
    sub->add_option(
           "--trials", a.trials,
           "trials of each subject, condition and delay (default: [protocol] trials_per_modality, else 1)")
        ->check(CLI::Range(1, 1000));
    as_session_seed(sub->add_option(
        "-s,--seed", a.seed, "seed of subjects, fixtures and networks (default: [session] seed, else 1)"));
    add_jobs_option(*sub, a.study.jobs);
    add_resume_options(*sub, a.if_exists, "comparison");
    sub->footer(
        "Columns of the table:\n"
        "  done      trials that ran to their end, of all\n"
        "  osc.      trials in which the needle oscillates, of all\n"
        "  p-p mm    peak-to-peak movement of the needle during the hold\n"
        "  pen mm    mean penetration\n"
        "  max mm    maximum penetration\n"
        "  time s    completion time\n"
        "  K / true  stiffness that the hand feels, divided by the stiffness of the fixture\n"
        "  drift     distance between hand and needle, mm\n"
        "  share     scaled: part of the force for the hand, chosen for the delay\n"
        "Example:\n  thimble compensators --subjects 10 --out out/compensators\n"
        "Manual: docs/compensators.md");
    return {sub, [arguments] { return compare_compensators(*arguments); }, true};
}

}  // namespace thimble
