// thimble analyse: the paper's claims on any table of trials.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "experiment/claims.hpp"
#include "experiment/commands/commands.hpp"
#include "experiment/sitting/counted_trials.hpp"
#include "experiment/trial_table.hpp"

namespace thimble {
namespace {

struct AnalyseArguments {
    std::string table, claims_out;
};

std::vector<TrialRow> rows_of(const std::filesystem::path& given) {
    if (!std::filesystem::is_directory(given)) return read_trial_table(given);
    const Dataset dataset(given);
    if (!dataset.kind()) return read_trial_table(given / "trials.csv");
    const CountedTrials counted = counted_trials(dataset);
    for (const std::string& line : describe(counted)) fmt::print("{}\n", line);
    return counted.rows;
}

// What a study wrote beside its trials; none, and the claim is not judged.
std::vector<TrialRow> no_lag_rows(const std::filesystem::path& given) {
    const auto folder = std::filesystem::is_directory(given) ? given : given.parent_path();
    const auto table = folder / "no_lag.csv";
    return std::filesystem::exists(table) ? read_trial_table(table) : std::vector<TrialRow>{};
}

int judge_table(const AnalyseArguments& arguments) {
    const std::vector<Claim> claims = judge_claims(rows_of(arguments.table), no_lag_rows(arguments.table));
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

}  // namespace

Command add_analyse(CLI::App& app) {
    const auto arguments = std::make_shared<AnalyseArguments>();
    AnalyseArguments& a = *arguments;
    CLI::App* analyse =
        app.add_subcommand("analyse", "the paper's claims on a table of trials, by its tests");
    analyse
        ->add_option("table", a.table, "a trials.csv, a folder that holds one, or a dataset of participants")
        ->required();
    analyse->add_option("-o,--out", a.claims_out, "claims as JSON");
    analyse->footer("Example:\n  thimble analyse out/study --out claims.json");
    return {analyse, [arguments] { return judge_table(*arguments); }};
}

}  // namespace thimble
