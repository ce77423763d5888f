// Many cases of the swarm, one per seed.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/swarm/watched_parts.hpp"

namespace thimble {

// One case of the swarm, from its start to its end.
struct SwarmOutcome {
    std::optional<Violation> violation;
    std::uint64_t digest = 0;  // of all outputs and samples
    double simulated_s = 0;
    std::vector<EndReason> ends;  // of the trials
};

// Removes from the case the keys that a reader refuses. `break_force`: null, but in a test that breaks something.
SwarmOutcome run_case(SwarmCase& one, const BreakForce& break_force = {});

// Removes faults, keys, the second trial and the lab key, as long as the case breaks the same invariant.
SwarmCase shrink(SwarmCase one, Rule broken, const BreakForce& break_force = {});

struct SwarmOptions {
    std::uint64_t seed = 1;  // of the first case; the next one has the next seed
    std::uint64_t cases = 1;
    unsigned jobs = 0;                        // 0: one per core
    std::filesystem::path out;                // of the smallest cases that fail
    std::filesystem::path plugin;             // that some cases have as their controller; empty: none
    const std::atomic<bool>* stop = nullptr;  // ends the swarm after the running cases
    std::size_t most_failures = 20;           // ends the swarm
    BreakForce break_force;                   // of tests
};

struct SwarmFailure {
    std::uint64_t seed = 0;
    Violation violation;
    SwarmCase smallest;
    std::filesystem::path file;  // that has it
};

struct SwarmResult {
    std::uint64_t cases = 0, trials = 0;
    double simulated_s = 0;
    std::array<std::uint64_t, static_cast<std::size_t>(FaultKind::kCount)> faults{};
    std::array<std::uint64_t, static_cast<std::size_t>(kLastEndReason) + 1> ends{};
    std::vector<SwarmFailure> failures;
    bool complete = false;
};

// Throws Error (run failed) if a file cannot be written.
SwarmResult run_swarm(const SwarmOptions& options);

// "seed 17: force-limit at 2.31 s: 13.2 N (...)", with the command that repeats it.
std::string failure_text(const SwarmFailure& failure);
std::string swarm_json(const SwarmOptions& options, const SwarmResult& result);

}  // namespace thimble
