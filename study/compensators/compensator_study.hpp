// Experiment 3 with each compensator in the place of HF, beside HF, CF, CCF and VF: the same subjects, trials, fixtures and delays for all.
// In virtual time; results do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
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

// One trial: what it is, then what came out.
struct CompensatorTrial {
    std::size_t condition = 0;  // of chosen_conditions()
    CompensatorNetwork network;
    TrialConditions conditions;
    double share = 1;  // of the force for the hand
    TrialMetrics metrics;
    bool completed = false;
    // As in CompensatorRow.
    double rendered_stiffness = std::numeric_limits<double>::quiet_NaN();
    double drift_needle_m = std::numeric_limits<double>::quiet_NaN();
};

// The result of one condition over one network.
struct CompensatorRow {
    std::string name;
    CompensatorNetwork network;
    std::uint32_t trials = 0, completed = 0, oscillating = 0;
    // Means over trials; NaN where there is none. Needle about its mean in the hold, as in metrics.hpp.
    double oscillation_peak_to_peak_m = std::numeric_limits<double>::quiet_NaN();
    double penetration_mean_m = std::numeric_limits<double>::quiet_NaN();
    double penetration_max_m = std::numeric_limits<double>::quiet_NaN();
    double completion_time_s = std::numeric_limits<double>::quiet_NaN();
    // Mean force of the handle over mean depth of the hand beyond the fixture, both in the hold, over the true stiffness.
    double rendered_stiffness = std::numeric_limits<double>::quiet_NaN();
    double drift_needle_m =
        std::numeric_limits<double>::quiet_NaN();  // mean of |scale x hand - needle| in the hold
    double share = 1;                              // of the force for the hand
};

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
