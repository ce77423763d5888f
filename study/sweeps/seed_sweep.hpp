// Repeated whole studies that keep only their claims. In which fraction of seeds does each claim come out?
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/claims/claims.hpp"
#include "analysis/report/report.hpp"
#include "common/csv/csv_file.hpp"
#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"
#include "study/sweeps/claim_tally.hpp"

namespace thimble {

// The options of every sweep over studies.
struct SweepOptions {
    std::vector<Protocol> protocols;  // with the first seed; the others follow it
    std::uint32_t seeds = 1;          // studies per setting
    std::filesystem::path out;
    std::string command;     // for the report's provenance
    Provenance made_with{};  // more of it: commit, session files, parameters
    unsigned jobs = 0;       // threads; 0: one per core
    IfExists if_exists = IfExists::kRefuse;
    const std::atomic<bool>* stop = nullptr;
};

// Makes the folder of a sweep and removes an earlier report. Where the report is to be replaced, the tables of an earlier study go as
// well. Throws Error (usage) if it may not be replaced.
void claim_folder(const SweepOptions& options);

// A table of claims, a line as each is judged: `columns`, then id, reproduced, direction.
class ClaimsFile {
  public:
    ClaimsFile(const std::string& name, const std::string& columns, const SweepOptions& options);
    void append(const std::string& cells, const std::vector<Claim>& claims);  // they are on the disk then

  private:
    CsvFile file_;
};

// A study for each seed: the protocols with this seed, and what the claims need besides (study.hpp). Counts the claims of each
// in `tally` and hands them to `take`. False if it was stopped; the study that was stopped counts nowhere.
bool judge_studies(const SweepOptions& options,
                   const std::function<SystemSettings(std::uint64_t seed)>& settings, ClaimTally& tally,
                   const std::function<void(std::uint64_t seed, const std::vector<Claim>&)>& take);

// report.html. `studies` of them were judged, each a `what` ("seeds").
void write_sweep_report(const SweepOptions& options, std::string title, std::vector<ReportSection> sections,
                        const std::string& what, std::uint32_t studies, bool complete);

// A study per seed or per draw.
struct TallyResult {
    ClaimTally tally;
    bool complete = true;  // false: interrupted, the studies that were done are in the tally
};

// Writes claims_seeds.csv (seed, id, reproduced, direction; as each seed ends), claims.json (write_tally) and
// report.html, fragile claims first. Trials are not kept.
TallyResult run_sweep(const SystemSettings& settings, const SweepOptions& options);

}  // namespace thimble
