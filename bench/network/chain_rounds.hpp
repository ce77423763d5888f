// The haptic loop as users run it: the five programs, a trial of the virtual operator, and what the nodes say of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/network/window_errors.hpp"
#include "common/error.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/time.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

struct ChainRound {
    WindowQuantiles round_trip;  // the master's, from encoder sample to its force
    double hold_us = 0;          // median, as slave_sim says it
    // From a node's waking to its next wait, median: everything between the system's two waits.
    double master_turn_us = 0, netem_turn_us = 0, slave_turn_us = 0;
};

// From the reports that the nodes wrote at their end. Throws Error (data) naming what is missing.
ChainRound read_chain_round(const std::vector<nlohmann::ordered_json>& reports);

struct ChainSettings {
    std::filesystem::path programs;  // folder of the thimble-* programs
    std::filesystem::path scratch;   // for logs, reports and trajectories; must exist
    std::uint16_t base_port = 0;
    RuntimeSettings runtime;
    Duration window{};                // after which the trial is ended; it may be over before
    std::filesystem::path lab_key{};  // empty: no protection
};

// Trials without delay in every modality, of subject 1 of the default session.
std::vector<TrialConditions> chain_trials();

struct ChainWindow {
    ExitCode code = ExitCode::kOk;
    std::string problem;  // why the trial ended early; empty if it did not
    EndReason reason = EndReason::kNone;
    std::vector<nlohmann::ordered_json> reports;
};

// Starts the five nodes on loopback, runs one trial, ends them. Throws Error as run_condition does.
ChainWindow run_window(const ChainSettings& settings, const TrialConditions& trial);
// The same; throws Error, run failed, if a stop was requested (realtime_loop.hpp), and whatever else ended the trial.
ChainRound run_chain(const ChainSettings& settings, const TrialConditions& trial);

}  // namespace thimble
