// `thimble study`: all trials of a session in virtual time, in this one process.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/claims/claims.hpp"
#include "analysis/text/html.hpp"
#include "session/records/mean_trajectory.hpp"
#include "session/records/trial_table.hpp"
#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"
#include "study/ordered_workers.hpp"

namespace thimble {

struct StudyOptions {
    std::vector<Protocol> protocols;  // one per experiment and delay, in order
    std::filesystem::path out;
    std::string command;  // as typed, for the report's provenance
    // More of it, as the report writes it: commit, session files, parameters.
    std::vector<std::pair<std::string, std::string>> made_with{};
    std::string plan{};                      // text of the values that are not in the session file
    unsigned jobs = 0;                       // threads; 0: one per core
    IfExists if_exists = IfExists::kRefuse;  // kContinue: goes on where an earlier study was interrupted
    bool trajectories = false;               // one file per trial
    CurveGrid curves = kContactGrid;         // of the mean trajectories
    // Of an experiment with delay that comes alone: the same trials without, into control.csv. Of experiment 1:
    // its trials with CF, with actuators without lag, into no_lag.csv.
    bool control = true;
    // The trials with HF again, with each of these in the handle's loop, into hf_NAME.csv: HF, each of them, CF, CCF and VF are then
    // compared (compensators.json, as findings.json). The paper's claims are about HF without.
    std::vector<Compensator> compensators{};
    std::vector<ReportTable> person{};        // of a twin: what this person's hand bears
    bool paper_design = true;                 // the paper's claims are judged only then
    const std::atomic<bool>* stop = nullptr;  // asked between trials
};

// Runs trials on `jobs` threads (0: one per core) and hands each record over in the order of `trials`, whatever order they end
// in. So no result depends on the number of threads. False if `stop` cut it short.
bool run_trials(const SystemSettings& settings, std::span<const TrialConditions> trials, unsigned jobs,
                const std::atomic<bool>* stop, const std::function<void(const TrialRecord&)>& take);

struct StudyResult {
    std::vector<TrialRow> rows;  // of trials.csv, then of control.csv
    std::vector<Claim> claims;   // empty unless the design is the paper's
    bool complete = true;
    std::size_t resumed = 0;             // rows that were there already
    double simulated_s = 0, wall_s = 0;  // of the trials alone, without report
};

// Writes below options.out: trials.csv (a row is on the disk as soon as its trial is in), trials.txt (plan, session), control.csv,
// no_lag.csv, hf_NAME.csv and the curves of each. After the trials it writes subjects.csv, findings.json, compensators.json,
// claims.json (the paper's design), report.html, summary.json and figures/.
StudyResult run_study(const SystemSettings& settings, const StudyOptions& options);

// subjects.csv: what was drawn for each virtual subject, SI units named in the columns. A line per subject of each cohort
// (experiments 1 and 2 have the same people). Replaces the file; throws Error as CsvFile.
void write_subjects(const std::filesystem::path& path, const OperatorParameters& parameters,
                    const std::vector<Protocol>& protocols);

// The price of the actuators' lag: experiment 1 again, with fingertip devices that need no time.

// The trials of experiment 1 with CF, under the same keys, so that nothing but the lag differs; none without
// an experiment 1.
std::vector<TrialConditions> no_lag_trials(const std::vector<Protocol>& protocols);

SystemSettings without_lag(SystemSettings settings);

}  // namespace thimble
