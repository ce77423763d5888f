#include "experiment/seed_sweep.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/version.hpp"
#include "experiment/progress.hpp"
#include "experiment/report.hpp"
#include "experiment/statistics/wilson.hpp"
#include "experiment/study.hpp"
#include "experiment/text_file.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

// Nothing if it was interrupted.
std::vector<TrialRow> rows_of(const SystemSettings& settings, const SweepOptions& options, std::uint64_t seed,
                              bool& complete) {
    std::vector<Protocol> protocols = options.protocols;
    for (Protocol& protocol : protocols) protocol.seed = seed;
    std::vector<TrialRow> rows;
    complete = run_trials(settings, all_trials(protocols), thread_count(options.jobs), options.stop,
                          [&](const TrialRecord& record) { rows.push_back(make_row(record)); });
    return rows;
}

void count(const std::vector<Claim>& claims, std::vector<ClaimCount>& counts) {
    if (counts.empty()) {
        for (const Claim& claim : claims) counts.push_back({claim, 0, 0});
    }
    for (std::size_t i = 0; i < claims.size(); ++i) {
        if (!claims[i].reproduced) continue;
        ++counts[i].judged;
        if (*claims[i].reproduced) ++counts[i].reproduced;
    }
}

std::string fraction_text(const ClaimCount& c) {
    if (c.judged == 0) return "not judged";
    const ConfidenceInterval interval = c.interval();
    return fmt::format("{:.0f} % ({:.0f} to {:.0f})", 100 * c.fraction(), 100 * interval.low,
                       100 * interval.high);
}

ReportTable counts_table(std::string title, const std::vector<ClaimCount>& counts, bool only_fragile) {
    ReportTable table{
        std::move(title),
        "Fraction of seeds in which direction and the paper's significance both come out, with its 95 % "
        "Wilson interval; what came out with the first seed.",
        {"id", "claim", "the paper", "seeds", "reproduced in", "with the first seed"},
        {}};
    for (const ClaimCount& c : counts) {
        if (only_fragile && !c.fragile()) continue;
        table.rows.push_back({c.claim.id, c.claim.claim, c.claim.paper, fmt::format("{}", c.judged),
                              fraction_text(c), c.claim.ours});
    }
    return table;
}

void write_json(const std::vector<ClaimCount>& counts, const std::filesystem::path& path) {
    Json list = Json::array();
    for (const ClaimCount& c : counts) {
        Claim over_all_seeds = c.claim;
        over_all_seeds.reproduced = c.judged == 0 ? std::nullopt : std::optional(!c.fragile());
        Json entry = to_json(over_all_seeds);
        entry["seeds_judged"] = c.judged;
        entry["seeds_reproduced"] = c.reproduced;
        if (c.judged > 0) {
            entry["fraction"] = c.fraction();
            entry["interval"] = {c.interval().low, c.interval().high};
        }
        list.push_back(std::move(entry));
    }
    write_text_file(path, list.dump(2) + "\n");
}

void report(const SweepOptions& options, const SweepResult& result) {
    const auto fragile = std::count_if(result.claims.begin(), result.claims.end(),
                                       [](const ClaimCount& c) { return c.fragile(); });
    ReportInput report;
    report.title = fmt::format("Thimble: the paper's claims over {} seeds", result.seeds);
    ReportSection section;
    section.title = fmt::format("{} of {} claims are fragile: below {:.0f} % of seeds", fragile,
                                result.claims.size(), 100 * kFragileBelow);
    if (fragile > 0) section.tables.push_back(counts_table("Fragile claims", result.claims, true));
    section.tables.push_back(counts_table("All claims", result.claims, false));
    report.sections.push_back(std::move(section));
    report.provenance = {{"command", options.command},
                         {"first seed", std::to_string(options.protocols[0].seed)},
                         {"seeds", std::to_string(result.seeds)},
                         {"version", kVersion},
                         {"complete", result.complete ? "yes" : "no, interrupted"}};
    write_report(report, options.out / "report.html");
}

}  // namespace

ConfidenceInterval ClaimCount::interval() const { return wilson_interval(reproduced, judged); }

SweepResult run_sweep(const SystemSettings& settings, const SweepOptions& options) {
    std::filesystem::create_directories(options.out);
    CsvFile file(options.out / "claims_seeds.csv", options.if_exists);
    file.write("seed,id,reproduced\n");
    SweepResult result;
    Progress progress;
    for (std::uint32_t i = 0; i < options.seeds && result.complete; ++i) {
        const std::uint64_t seed = options.protocols[0].seed + i;
        const std::vector<TrialRow> rows = rows_of(settings, options, seed, result.complete);
        if (!result.complete) break;
        const std::vector<Claim> claims = judge_claims(rows);
        count(claims, result.claims);
        for (const Claim& c : claims) {
            file.write(
                fmt::format("{},{},{}\n", seed, c.id, c.reproduced ? (*c.reproduced ? "1" : "0") : ""));
        }
        file.sync();
        ++result.seeds;
        progress.show(
            fmt::format("seed {}: {} of {}; {}", seed, result.seeds, options.seeds, claims_sentence(claims)),
            true);
    }
    if (result.seeds == 0) return result;
    write_json(result.claims, options.out / "claims.json");
    report(options, result);
    return result;
}

}  // namespace thimble
