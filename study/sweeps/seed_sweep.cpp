#include "study/sweeps/seed_sweep.hpp"

#include <fmt/format.h>

#include "analysis/report/report.hpp"
#include "common/process/progress.hpp"

namespace thimble {
namespace {

void report(const SweepOptions& options, const TallyResult& result) {
    ReportInput report;
    report.title = fmt::format("Thimble: the paper's claims over {} seeds", result.tally.studies());
    ReportSection section;
    section.title = fmt::format("{} of {} claims are fragile: below {:.0f} % of seeds",
                                result.tally.fragile(), result.tally.counts().size(), 100 * kFragileBelow);
    if (result.tally.fragile() > 0) {
        section.tables.push_back(tally_table("Fragile claims", result.tally, "seeds", true));
    }
    section.tables.push_back(tally_table("All claims", result.tally, "seeds", false));
    report.sections.push_back(std::move(section));
    report.provenance = sweep_provenance(options, "seeds", result.tally.studies(), result.complete);
    write_report(report, options.out / "report.html");
}

}  // namespace

TallyResult run_sweep(const SystemSettings& settings, const SweepOptions& options) {
    claim_folder(options);
    CsvFile file(options.out / "claims_seeds.csv", options.if_exists);
    file.write("seed,id,reproduced,direction\n");
    TallyResult result;
    Progress progress;
    for (std::uint32_t i = 0; i < options.seeds; ++i) {
        const std::uint64_t seed = options.protocols[0].seed + i;
        const auto claims = judge_study(settings, options, seed);
        if (!claims) {
            result.complete = false;
            break;
        }
        result.tally.add(*claims);
        for (const Claim& c : *claims) file.write(fmt::format("{},{}", seed, claim_cells(c)));
        file.sync();
        progress.show(
            fmt::format("seed {}: {} of {}; {}", seed, i + 1, options.seeds, claims_sentence(*claims)), true);
    }
    if (result.tally.studies() == 0) return result;
    write_tally(result.tally, options.out / "claims.json");
    report(options, result);
    return result;
}

}  // namespace thimble
