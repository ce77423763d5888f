// thimble remedies: experiment 3 with each remedy against delay, beside HF, CF, CCF and VF.
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "experiment/commands/commands.hpp"
#include "experiment/csv.hpp"
#include "experiment/csv_file.hpp"
#include "experiment/remedies/remedy_study.hpp"

namespace thimble {
namespace {

struct RemediesArguments {
    std::string config, out;
    std::vector<double> delays_ms{0, 10, 25, 50, 100, 200};
    RemedyStudyOptions study;
    bool overwrite = false;
};

constexpr const char* kRemedyColumns =
    "condition,delay_s,trials,completed,oscillating,oscillation_peak_to_peak_m,penetration_mean_m,"
    "penetration_max_m,"
    "completion_time_s,rendered_stiffness,drift_needle_m,hand_share\n";

void write_rows(const std::filesystem::path& path, IfExists if_exists, const std::vector<RemedyRow>& rows) {
    CsvFile file(path, if_exists);
    file.write(kRemedyColumns);
    for (const RemedyRow& row : rows) {
        std::string line =
            fmt::format("{},{},{},{},{}", row.name, row.delay_s, row.trials, row.completed, row.oscillating);
        for (const double value :
             {row.oscillation_peak_to_peak_m, row.penetration_mean_m, row.penetration_max_m,
              row.completion_time_s, row.rendered_stiffness, row.drift_needle_m, row.share}) {
            line += ',';
            write_number(std::back_inserter(line), value);
        }
        file.write(line + '\n');
    }
    file.sync();
}

std::string cell(double value, int decimals) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

void print_rows(const std::vector<RemedyRow>& rows) {
    fmt::print("{:<24}{:>6}{:>7}{:>7}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}{:>8}\n", "condition", "ms", "done",
               "osc.", "p-p mm", "pen mm", "max mm", "time s", "K / true", "drift", "share");
    for (const RemedyRow& row : rows) {
        fmt::print("{:<24}{:>6.4g}{:>7}{:>7}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}{:>8}\n", row.name,
                   1000 * row.delay_s, fmt::format("{}/{}", row.completed, row.trials),
                   fmt::format("{}/{}", row.oscillating, row.trials),
                   cell(1000 * row.oscillation_peak_to_peak_m, 2), cell(1000 * row.penetration_mean_m, 2),
                   cell(1000 * row.penetration_max_m, 2), cell(row.completion_time_s, 2),
                   cell(row.rendered_stiffness, 3), cell(1000 * row.drift_needle_m, 2), cell(row.share, 3));
    }
}

int compare_remedies(RemediesArguments arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    if (held_by_person(settings.handle.kind))
        throw Error(ExitCode::kUsage, "thimble remedies needs the virtual operator: remove [handle] device");
    install_stop_signals();
    arguments.study.stop = &stop_requested();
    arguments.study.delays_s.clear();
    for (const double delay_ms : arguments.delays_ms) arguments.study.delays_s.push_back(delay_ms / 1000);
    std::filesystem::path path;
    if (!arguments.out.empty()) {
        std::filesystem::create_directories(arguments.out);
        path = std::filesystem::path(arguments.out) / "remedies.csv";
        if (!arguments.overwrite && std::filesystem::exists(path))
            throw Error(ExitCode::kUsage,
                        path.string() + " exists: choose another folder, or say --overwrite");
    }
    const std::vector<RemedyRow> rows = run_remedy_study(settings, arguments.study);
    if (rows.empty()) throw Error(ExitCode::kRunFailed, "interrupted: no results");
    print_rows(rows);
    if (!path.empty()) {
        write_rows(path, IfExists::kReplace, rows);
        fmt::print("table: {}\n", path.string());
    }
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

Subcommand add_remedies(CLI::App& app) {
    const auto arguments = std::make_shared<RemediesArguments>();
    RemediesArguments& a = *arguments;
    CLI::App* sub = app.add_subcommand(
        "remedies", "experiment 3 in virtual time with each remedy against delay, beside HF, CF, CCF and VF");
    sub->add_option("--config", a.config, "session file (TOML); its network holds, but for the force delay");
    sub->add_option("--out", a.out, "folder for remedies.csv");
    sub->add_option("--delays-ms", a.delays_ms, "delays of the force path, one way")
        ->check(CLI::Range(0.0, 10000.0))
        ->capture_default_str();
    sub->add_option("--only", a.study.names, "these conditions alone, e.g. HF CF wave");
    sub->add_option("--subjects", a.study.subjects, "virtual subjects")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    sub->add_option("--trials", a.study.trials, "of each subject, condition and delay")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    sub->add_option("--seed", a.study.seed, "of subjects, fixtures and networks")->capture_default_str();
    sub->add_option("--jobs", a.study.jobs, "threads; 0: one per core")->capture_default_str();
    sub->add_flag("--overwrite", a.overwrite, "replace an earlier table");
    sub->footer(
        "done: completed trials; osc.: those in which the needle oscillates; K / true: stiffness that the "
        "hand "
        "feels over the fixture's; drift: between hand and needle, mm of needle; share: of the force for the "
        "hand.\n"
        "Example:\n  thimble remedies --subjects 10 --out out/remedies");
    return {sub, [arguments] { return compare_remedies(*arguments); }};
}

}  // namespace thimble
