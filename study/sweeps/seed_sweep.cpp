#include "study/sweeps/seed_sweep.hpp"

#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "common/process/progress.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/planned_table.hpp"
#include "study/power/power.hpp"
#include "study/study.hpp"
#include "study/study_folder.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

// False if it was stopped.
bool run_into(std::vector<TrialRow>& rows, const SystemSettings& settings,
              const std::vector<TrialConditions>& trials, const SweepOptions& options) {
    return run_in_order<TrialRow>(
        trials.size(), options.jobs, options.stop,
        [&](std::size_t i) { return make_row(run_virtual_trial(settings, trials[i])); },
        [&](const TrialRow& row) { rows.push_back(row); }, ResultsGo::kToAll,
        [&] { return session_text(settings); });
}

// Nothing if it was stopped.
std::optional<std::vector<Claim>> judge_study(const SystemSettings& settings, const SweepOptions& options,
                                              std::uint64_t seed) {
    std::vector<Protocol> protocols = options.protocols;
    for (Protocol& protocol : protocols) {
        protocol.seed = seed;
        // These, too, may be what is varied.
        protocol.fixture_position_m = settings.slave.fixture_position_m();
        protocol.fixture_jitter_m = settings.plan.fixture_jitter_m;
    }
    std::vector<TrialRow> rows, no_lag;
    const bool complete = run_into(rows, settings, all_trials(protocols), options) &&
                          run_into(no_lag, without_lag(settings), no_lag_trials(protocols), options);
    if (!complete) return std::nullopt;
    return judge_claims(rows, no_lag);
}

// The tables of an earlier study would pass for those of these studies.
void remove_study(const std::filesystem::path& folder) {
    const auto table = folder / "trials.csv";
    std::error_code absent;
    if (std::filesystem::exists(table, absent))
        CsvFile(table, IfExists::kContinue);  // an Error if another program writes it
    remove_file(table);
    remove_earlier_results(folder);
}

}  // namespace

void claim_folder(const SweepOptions& options) {
    if (options.if_exists != IfExists::kReplace) refuse_other_report(options.out);
    make_folder(options.out);
    if (options.if_exists == IfExists::kReplace) remove_study(options.out);
    for (const char* name : {"report.html", "claims.json", "vary.json"}) {
        std::filesystem::remove(options.out / name);
    }
}

ClaimsFile::ClaimsFile(const std::string& name, const std::string& columns, const SweepOptions& options)
    : file_(options.out / name, options.if_exists) {
    file_.write(columns + ",id,reproduced,direction\n");
}

void ClaimsFile::append(const std::string& cells, const std::vector<Claim>& claims) {
    for (const Claim& claim : claims) file_.write(fmt::format("{},{}", cells, claim_cells(claim)));
    file_.sync();
}

bool judge_studies(const SweepOptions& options,
                   const std::function<SystemSettings(std::uint64_t seed)>& settings, ClaimTally& tally,
                   const std::function<void(std::uint64_t seed, const std::vector<Claim>&)>& take) {
    for (std::uint32_t i = 0; i < options.seeds; ++i) {
        const std::uint64_t seed = options.protocols[0].seed + i;
        const auto claims = judge_study(settings(seed), options, seed);
        if (!claims) return false;
        tally.add(*claims);
        take(seed, *claims);
    }
    return true;
}

void write_sweep_report(const SweepOptions& options, std::string title, std::vector<ReportSection> sections,
                        const std::string& what, std::uint32_t studies, bool complete) {
    ReportInput report{std::move(title), std::move(sections), {}};
    report.provenance = {{"command", options.command},
                         {"first seed", std::to_string(options.protocols[0].seed)},
                         {what, std::to_string(studies)},
                         {"version", kVersion},
                         {"complete", complete ? "yes" : "no, interrupted"}};
    report.provenance.insert(report.provenance.end(), options.made_with.begin(), options.made_with.end());
    say_virtual_subjects(report);
    write_report(report, options.out / "report.html");
}

TallyResult run_sweep(const SystemSettings& settings, const SweepOptions& options) {
    claim_folder(options);
    ClaimsFile file("claims_seeds.csv", "seed", options);
    Progress progress;
    TallyResult result;
    const ClaimTally& tally = result.tally;
    const auto take = [&](std::uint64_t seed, const std::vector<Claim>& claims) {
        file.append(std::to_string(seed), claims);
        progress.count(tally.studies(), options.seeds, "seeds",
                       fmt::format("seed {}: {}", seed, claims_sentence(claims)));
    };
    result.complete = judge_studies(
        options, [&](std::uint64_t) { return settings; }, result.tally, take);
    if (tally.studies() == 0) return result;
    write_tally(tally, options.out / "claims.json");
    ReportSection section;
    section.title = fmt::format("{} of {} claims are fragile: reproduced in fewer than {:.0f} % of seeds",
                                tally.fragile(), tally.counts().size(), 100 * kFragileBelow);
    if (tally.fragile() > 0) section.tables.push_back(tally_table("Fragile claims", tally, "seeds", true));
    section.tables.push_back(tally_table("All claims", tally, "seeds", false));
    write_sweep_report(options, fmt::format("Thimble: the paper's claims over {} seeds", tally.studies()),
                       {section}, "seeds", tally.studies(), result.complete);
    return result;
}

}  // namespace thimble
