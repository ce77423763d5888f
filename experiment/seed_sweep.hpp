// The whole study again with one seed after another: in which fraction of seeds does each claim come out?
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/claims.hpp"
#include "experiment/csv_file.hpp"
#include "experiment/protocol.hpp"
#include "experiment/statistics/confidence_interval.hpp"

namespace thimble {

// A claim that comes out less often is called fragile.
inline constexpr double kFragileBelow = 0.8;

struct ClaimCount {
    Claim claim;  // as judged for the first seed
    std::uint32_t judged = 0;
    std::uint32_t reproduced = 0;

    double fraction() const { return judged > 0 ? static_cast<double>(reproduced) / judged : 0; }
    ConfidenceInterval interval() const;  // Wilson, 95 %; judged > 0
    bool fragile() const { return judged > 0 && fraction() < kFragileBelow; }
};

struct SweepOptions {
    std::vector<Protocol> protocols;  // with the first seed; the others follow it
    std::uint32_t seeds = 1;
    std::filesystem::path out;
    std::string command;  // for the report's provenance
    unsigned jobs = 0;    // threads; 0: one per core
    IfExists if_exists = IfExists::kRefuse;
    const std::atomic<bool>* stop = nullptr;
};

struct SweepResult {
    std::vector<ClaimCount> claims;
    std::uint32_t seeds = 0;  // done
    bool complete = true;
};

// Writes claims_seeds.csv (seed, id, reproduced; as each seed ends), claims.json (with seeds_judged,
// seeds_reproduced, fraction and its interval) and report.html, fragile claims first. Trials are not kept.
SweepResult run_sweep(const SystemSettings& settings, const SweepOptions& options);

}  // namespace thimble
