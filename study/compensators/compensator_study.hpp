// Experiment 3 with each compensator in the place of HF, beside HF, CF, CCF and VF: the same subjects, trials, fixtures and delays for all.
// In virtual time; results do not depend on the number of threads.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "session/records/metrics.hpp"
#include "session/records/trial_record.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// One line of the comparison: a modality, and in HF perhaps a compensator.
struct CompensatorCondition {
    std::string name;  // "HF", "CF", ..., or the compensator's
    Modality modality = Modality::kHF;
    ControlSettings control{};
};
// HF, CF, CCF, VF, then each compensator with the settings' own numbers ([control]'s keys belong to one compensator: the others have their
// defaults).
std::vector<CompensatorCondition> compensator_conditions(const SystemSettings& settings);

// The largest share of the fixture's stiffness that the linear loop of the nominal hand bears at this delay there and back,
// half a sample added, times `margin`; at most 1. Dry friction, which steadies, is left out.
double stable_share(const SystemSettings& settings, double delay_s, double margin = 0.8);

// The session's network, but for the force path's delay, one way, and where they are above zero its jitter (uniform, plus and
// minus) and the loss on both ways.
struct CompensatorNetwork {
    std::string name;
    double delay_s = 0;
    double jitter_spread_s = 0;
    double loss = 0;
};
std::vector<CompensatorNetwork> plain_networks(const std::vector<double>& delays_s);
SystemSettings over_network(SystemSettings settings, const CompensatorNetwork& network);

// Of the fixture, as a handle without delay would render it.
double true_stiffness_hand_N_per_m(const SystemSettings& settings);

struct CompensatorOutcome {
    TrialMetrics metrics{};
    bool completed = false;
    // As in CompensatorRow.
    double rendered_stiffness = TrialMetrics::kNone;
    double drift_needle_m = TrialMetrics::kNone;
};
// One trial: what it is, and what came out.
struct CompensatorTrial : CompensatorOutcome {
    std::size_t condition = 0;  // of chosen_conditions()
    CompensatorNetwork network{};
    TrialConditions conditions{};
    double share = TrialMetrics::kNone;  // scaled alone: of the force, for the hand
};

// The result of one condition over one network.
struct CompensatorRow {
    std::string name;
    CompensatorNetwork network;
    std::uint32_t trials = 0, completed = 0, oscillating = 0;
    // Means over trials; NaN where there is none. Needle about its mean in the hold, as in metrics.hpp.
    double oscillation_peak_to_peak_m = TrialMetrics::kNone;
    double penetration_mean_m = TrialMetrics::kNone;
    double penetration_max_m = TrialMetrics::kNone;
    double completion_time_s = TrialMetrics::kNone;
    // Mean force of the handle over mean depth of the hand beyond the fixture, both in the hold, over the true stiffness.
    double rendered_stiffness = TrialMetrics::kNone;
    double drift_needle_m = TrialMetrics::kNone;  // mean of |scale x hand - needle| in the hold
    double share = TrialMetrics::kNone;           // scaled alone: of the force, for the hand
};

// A measured value of a trial is a column of the tables. A row has the mean over its trials.
struct CompensatorValue {
    const char* column;
    double CompensatorRow::*of_row;
    double TrialMetrics::*of_metrics;  // null: of the trial itself
    double CompensatorOutcome::*of_trial;

    template <class Trial>
    auto& of(Trial& trial) const {
        return of_metrics != nullptr ? trial.metrics.*of_metrics : trial.*of_trial;
    }
};
inline constexpr std::array<CompensatorValue, 6> kCompensatorValues{
    {{"oscillation_peak_to_peak_m", &CompensatorRow::oscillation_peak_to_peak_m,
      &TrialMetrics::oscillation_peak_to_peak_m, nullptr},
     {"penetration_mean_m", &CompensatorRow::penetration_mean_m, &TrialMetrics::penetration_mean_m, nullptr},
     {"penetration_max_m", &CompensatorRow::penetration_max_m, &TrialMetrics::penetration_max_m, nullptr},
     {"completion_time_s", &CompensatorRow::completion_time_s, &TrialMetrics::completion_time_s, nullptr},
     {"rendered_stiffness", &CompensatorRow::rendered_stiffness, nullptr,
      &CompensatorOutcome::rendered_stiffness},
     {"drift_needle_m", &CompensatorRow::drift_needle_m, nullptr, &CompensatorOutcome::drift_needle_m}}};

struct CompensatorStudyOptions {
    std::vector<CompensatorNetwork> networks = plain_networks({0, 0.010, 0.025, 0.050, 0.100, 0.200});
    std::vector<std::string> names;  // of conditions; none: all
    std::uint32_t subjects = 10, trials = 1;
    std::uint64_t seed = 1;
    unsigned jobs = 0;  // threads; 0: one per core
    const std::atomic<bool>* stop = nullptr;
};

// Those of compensator_conditions() that are named; all if none is. Throws Error (usage) for a name that is none.
std::vector<CompensatorCondition> chosen_conditions(const SystemSettings& settings,
                                                    const std::vector<std::string>& names);

std::vector<std::string> names_of(const std::vector<CompensatorCondition>& conditions);

// The settings that decide the trials: another one gives another table. A session file's own network and [control] among it.
std::string compensator_plan(const SystemSettings& settings, const CompensatorStudyOptions& options);

// Conditions in the order of compensator_conditions(), networks inside, subjects and trials inside those. Nothing has come out yet.
std::vector<CompensatorTrial> plan_compensator_trials(const SystemSettings& settings,
                                                      const CompensatorStudyOptions& options);
// Runs these of the plan and hands each over in its order, with what came out. False if it was stopped before the last.
bool run_compensator_trials(const SystemSettings& settings, const CompensatorStudyOptions& options,
                            std::span<CompensatorTrial> trials,
                            const std::function<void(const CompensatorTrial&)>& take);
// All trials of the plan, a row for each condition and network.
std::vector<CompensatorRow> condense(const SystemSettings& settings, const CompensatorStudyOptions& options,
                                     const std::vector<CompensatorTrial>& trials);

// All of it; nothing if it was stopped.
std::vector<CompensatorRow> run_compensator_study(const SystemSettings& settings,
                                                  const CompensatorStudyOptions& options);

}  // namespace thimble
