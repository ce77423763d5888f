// Experiment 3 with each remedy in the place of HF, beside HF, CF, CCF and VF: the same subjects, trials, fixtures and delays for all.
// In virtual time; results do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "experiment/system_settings.hpp"

namespace thimble {

// One line of the comparison: a modality, and in HF perhaps a remedy.
struct RemedyCondition {
    std::string name;  // "HF", "CF", ..., or the remedy's
    Modality modality = Modality::kHF;
    ControlSettings control{};
};
// HF, CF, CCF, VF, then each remedy with the settings' own numbers ([control]'s keys belong to one remedy: the others have their
// defaults).
std::vector<RemedyCondition> remedy_conditions(const SystemSettings& settings);

// The largest share of the fixture's stiffness that the linear loop of the nominal hand bears at this delay there and back,
// half a sample added, times `margin`; at most 1. Dry friction, which steadies, is left out.
double stable_share(const SystemSettings& settings, double delay_s, double margin = 0.8);

// What came out for one condition at one delay of the force path, one way.
struct RemedyRow {
    std::string name;
    double delay_s = 0;
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

struct RemedyStudyOptions {
    std::vector<double> delays_s{0, 0.010, 0.025, 0.050, 0.100, 0.200};
    std::vector<std::string> names;  // of conditions; none: all
    std::uint32_t subjects = 10, trials = 1;
    std::uint64_t seed = 1;
    unsigned jobs = 0;  // threads; 0: one per core
    const std::atomic<bool>* stop = nullptr;
};

// Conditions in the order of remedy_conditions(), delays inside. Fewer if it was stopped. Throws Error (usage) for a name that
// is none.
std::vector<RemedyRow> run_remedy_study(const SystemSettings& settings, const RemedyStudyOptions& options);

}  // namespace thimble
