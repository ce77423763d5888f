// thimble analyse: the findings of any table of trials, and the paper's claims where the design is the paper's.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/claims/claims.hpp"
#include "analysis/findings.hpp"
#include "analysis/report/report.hpp"
#include "analysis/report/report_tables.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "session/participant/counted_trials.hpp"
#include "session/records/trial_table.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct AnalyseArguments {
    std::string table, out;
    bool json = false;
};

struct Analysis {
    std::vector<std::string> counted;  // which trials of a dataset count, and why others do not
    std::vector<GroupFindings> findings;
    std::vector<ReportTable> order;  // mixed models on single trials
    std::vector<Claim> claims;       // empty unless the design is the paper's
};

// With the same trials without delay, where the study had them.
std::vector<TrialRow> rows_of_study(const std::filesystem::path& folder) {
    std::vector<TrialRow> rows = read_trial_table(folder / "trials.csv");
    if (!std::filesystem::exists(folder / "control.csv")) return rows;
    const std::vector<TrialRow> control = read_trial_table(folder / "control.csv");
    rows.insert(rows.end(), control.begin(), control.end());
    return rows;
}

// `counted` gets which trials of a dataset count, and why others do not.
std::vector<TrialRow> rows_of(const std::filesystem::path& given, std::vector<std::string>& counted) {
    if (!std::filesystem::is_directory(given)) return read_trial_table(given);
    const Dataset dataset(given);
    if (!dataset.kind()) return rows_of_study(given);
    const CountedTrials trials = counted_trials(dataset);
    counted = describe(trials);
    return trials.rows;
}

std::filesystem::path folder_of(const std::filesystem::path& given) {
    return std::filesystem::is_directory(given) ? given : given.parent_path();
}

// A table that the study wrote beside its trials. Without it the claim is not judged.
std::vector<TrialRow> no_lag_rows(const std::filesystem::path& given) {
    const auto table = folder_of(given) / "no_lag.csv";
    return std::filesystem::exists(table) ? read_trial_table(table) : std::vector<TrialRow>{};
}

// A table beside the trials of a study, such as hf_wave.csv: the study's design, findings and claims are not about it.
bool is_side_table(const std::filesystem::path& given) {
    const bool trials = std::filesystem::is_directory(given) || given.filename() == "trials.csv";
    return !trials && design_in(folder_of(given)).has_value();
}

// As the study said it; of a table by itself as its rows say it.
bool has_papers_design(const std::filesystem::path& given, const std::vector<TrialRow>& rows) {
    if (is_side_table(given)) return false;
    const auto design = design_in(folder_of(given));
    return design ? *design != kUsersDesign : are_paper_trials(rows);
}

Analysis analyse(const std::filesystem::path& given) {
    Analysis analysis;
    const std::vector<TrialRow> rows = rows_of(given, analysis.counted);
    analysis.findings = findings_of(rows);
    analysis.order = order_tables(rows);
    if (has_papers_design(given, rows)) analysis.claims = judge_claims(rows, no_lag_rows(given));
    return analysis;
}

// findings.json in the folder of a study or a run.
bool is_of_other_trials(const std::filesystem::path& given, const std::filesystem::path& file) {
    const std::filesystem::path folder = file.parent_path();
    if (file.filename() != "findings.json" || !design_in(folder)) return false;
    std::error_code unknown;
    return is_side_table(given) ||
           !std::filesystem::equivalent(folder_of(given) / "summary.json", folder / "summary.json", unknown);
}

// Other files of the run, the study or the dataset that end in .json, too.
void refuse_results(const std::filesystem::path& given, const std::filesystem::path& file) {
    if (is_of_other_trials(given, file))
        throw Error(ExitCode::kUsage,
                    "--out {}: this folder has the findings of its own trials.csv: name another folder, or a "
                    "file",
                    file.string());
    std::error_code unknown;
    for (const char* name : {"", "summary.json", "claims.json", "compensators.json", "participants.json",
                             "dataset_description.json", "task-needle_beh.json"}) {
        const auto result = *name == '\0' ? given : folder_of(given) / name;
        if (std::filesystem::equivalent(result, file, unknown))
            throw Error(ExitCode::kUsage, "--out {}: is a result already: name another file, or a folder",
                        file.string());
    }
}

void write_to(const std::filesystem::path& out, const std::filesystem::path& given,
              const Analysis& analysis) {
    const std::filesystem::path file = output_file(out, "findings.json");
    refuse_results(given, file);
    write_findings(analysis.findings, file);
    if (file == out) return;
    if (!analysis.claims.empty()) return write_claims(analysis.claims, out / "claims.json");
    remove_file(out / "claims.json");  // of an earlier analysis
}

void say(const Analysis& analysis) {
    for (const std::string& line : analysis.counted) fmt::print("{}\n", line);
    for (const std::string& sentence : answer(analysis.findings)) fmt::print("{}\n", sentence);
    for (const ReportTable& table : finding_tables(analysis.findings)) fmt::print("\n{}", plain_table(table));
    for (const ReportTable& table : analysis.order) fmt::print("\n{}", plain_table(table));
    if (analysis.claims.empty()) return;
    const ReportTable table = claims_table(analysis.claims);
    if (!table.rows.empty()) fmt::print("\n{}", plain_table(table));
    fmt::print("{}.\n", claims_sentence(analysis.claims));
}

void say_json(const Analysis& analysis) {
    nlohmann::ordered_json json{{"counted", analysis.counted}};
    json["answer"] = answer(analysis.findings);
    json["findings"] = to_json(analysis.findings);
    if (!analysis.claims.empty()) json["claims"] = nlohmann::ordered_json::array();
    for (const Claim& claim : analysis.claims) json["claims"].push_back(to_json(claim));
    fmt::print("{}\n", json_text(json, 2));
}

int analyse_table(const AnalyseArguments& arguments) {
    const Analysis analysis = analyse(arguments.table);
    if (!arguments.out.empty()) write_to(arguments.out, arguments.table, analysis);
    arguments.json ? say_json(analysis) : say(analysis);
    return 0;
}

}  // namespace

Subcommand add_analyse(CLI::App& app) {
    const auto arguments = std::make_shared<AnalyseArguments>();
    AnalyseArguments& a = *arguments;
    CLI::App* analyse = app.add_subcommand(
        "analyse", "find which conditions oscillate and how they differ, in a table of trials");
    analyse
        ->add_option("table", a.table,
                     "a trials.csv, a folder that holds one, or a folder with participants' data")
        ->required();
    analyse
        ->add_option("-o,--out", a.out,
                     "folder for findings.json (and claims.json, if the trials are the paper's), or a file "
                     "for the findings, which ends in .json")
        ->type_name("FOLDER|FILE");
    analyse->add_flag("--json", a.json,
                      "print answer, findings and claims as JSON on stdout, instead of text");
    analyse->footer(
        "Examples:\n  thimble analyse out/study --out out/analysis\n"
        "  thimble analyse out/study/trials.csv --json\n"
        "Manual: docs/studies.md");
    return {analyse, [arguments] { return analyse_table(*arguments); }};
}

}  // namespace thimble
