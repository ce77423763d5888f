// A whole study that keeps only its claims.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/claims/claims.hpp"
#include "common/csv/csv_file.hpp"
#include "session/settings/protocol.hpp"

namespace thimble {

// The options of every sweep over studies.
struct SweepOptions {
    std::vector<Protocol> protocols;  // with the first seed; the others follow it
    std::uint32_t seeds = 1;          // studies per setting
    std::filesystem::path out;
    std::string command;  // for the report's provenance
    unsigned jobs = 0;    // threads; 0: one per core
    IfExists if_exists = IfExists::kRefuse;
    const std::atomic<bool>* stop = nullptr;
};

// The folder of a sweep, empty of an earlier report: throws Error (usage) if there is one that may not be
// replaced.
void claim_folder(const SweepOptions& options);
// For the report of `studies` studies, each a `what` ("seeds").
std::vector<std::pair<std::string, std::string>> sweep_provenance(const SweepOptions& options,
                                                                  const std::string& what,
                                                                  std::uint32_t studies, bool complete);

// The protocols with this seed, and what the claims need besides (study.hpp); nothing if it was stopped.
std::optional<std::vector<Claim>> judge_study(const SystemSettings& settings, const SweepOptions& options,
                                              std::uint64_t seed);

}  // namespace thimble
