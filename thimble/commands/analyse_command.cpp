// thimble analyse: the paper's claims and the analysis of every measure on any table of trials.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/analysis.hpp"
#include "analysis/claims/claims.hpp"
#include "common/json_text.hpp"
#include "session/participant/counted_trials.hpp"
#include "session/records/trial_table.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct AnalyseArguments {
    std::string table, claims_out, analysis = "full";
    bool json = false;
};

// `counted` gets which trials of a dataset count, and why others do not.
std::vector<TrialRow> rows_of(const std::filesystem::path& given, std::vector<std::string>& counted) {
    if (!std::filesystem::is_directory(given)) return read_trial_table(given);
    const Dataset dataset(given);
    if (!dataset.kind()) return read_trial_table(given / "trials.csv");
    const CountedTrials trials = counted_trials(dataset);
    counted = describe(trials);
    return trials.rows;
}

// A table that the study wrote beside its trials. Without it the claim is not judged.
std::vector<TrialRow> no_lag_rows(const std::filesystem::path& given) {
    const auto folder = std::filesystem::is_directory(given) ? given : given.parent_path();
    const auto table = folder / "no_lag.csv";
    return std::filesystem::exists(table) ? read_trial_table(table) : std::vector<TrialRow>{};
}

void say_claims(const std::vector<Claim>& claims) {
    for (const Claim& c : claims) {
        fmt::print("{:<12} {:<18} {}\n{:<12} paper: {}\n{:<12} here:  {}\n",
                   !c.reproduced   ? "not judged"
                   : *c.reproduced ? "reproduced"
                                   : "no",
                   c.id, c.claim, "", c.paper, "", c.ours);
    }
    fmt::print("{}\n", claims_sentence(claims));
}

void say_analysis(const std::vector<MeasureAnalysis>& measures) {
    for (const std::uint32_t experiment : {1U, 2U, 3U}) {
        std::vector<MeasureAnalysis> own;
        for (const MeasureAnalysis& measure : measures) {
            if (measure.experiment == experiment) own.push_back(measure);
        }
        if (own.empty()) continue;
        fmt::print("\nExperiment {}\n", experiment);
        for (const MeasureAnalysis& measure : own) fmt::print("{}\n", finding_text(measure));
        for (const ReportTable& table : analysis_tables(own)) fmt::print("\n{}", plain_table(table));
    }
}

int analyse_table(const AnalyseArguments& arguments) {
    std::vector<std::string> counted;
    const std::vector<TrialRow> rows = rows_of(arguments.table, counted);
    const std::vector<Claim> claims = judge_claims(rows, no_lag_rows(arguments.table));
    if (!arguments.claims_out.empty()) write_claims(claims, arguments.claims_out);
    const AnalysisKind kind = *parse_analysis(arguments.analysis);
    const std::vector<MeasureAnalysis> measures = analyse_trials(rows, kind);
    if (arguments.json) {
        nlohmann::ordered_json json{{"counted", counted}};
        json["claims"] = nlohmann::ordered_json::array();
        for (const Claim& claim : claims) json["claims"].push_back(to_json(claim));
        json["analysis"] = to_json(measures, kind);
        fmt::print("{}\n", json_text(json, 2));
    } else {
        for (const std::string& line : counted) fmt::print("{}\n", line);
        say_claims(claims);
        say_analysis(measures);
    }
    return 0;
}

}  // namespace

Subcommand add_analyse(CLI::App& app) {
    const auto arguments = std::make_shared<AnalyseArguments>();
    AnalyseArguments& a = *arguments;
    CLI::App* analyse = app.add_subcommand(
        "analyse", "the paper's claims and an analysis of every measure on a table of trials");
    analyse
        ->add_option("table", a.table, "a trials.csv, a folder that holds one, or a dataset of participants")
        ->required();
    analyse->add_option("-o,--out", a.claims_out, "claims as JSON");
    add_analysis_option(*analyse, a.analysis);
    analyse->add_flag("--json", a.json, "print claims and analysis as JSON on stdout");
    analyse->footer(
        "Examples:\n  thimble analyse out/study --out claims.json\n"
        "  thimble analyse out/study/trials.csv --analysis paper --json");
    return {analyse, [arguments] { return analyse_table(*arguments); }};
}

}  // namespace thimble
