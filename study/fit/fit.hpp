// thimble fit: the virtual operator that moves as one participant does in recorded trials.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/text/html.hpp"
#include "common/csv/csv_file.hpp"
#include "session/records/trial_table.hpp"
#include "session/settings/system_settings.hpp"
#include "study/fit/operator_model.hpp"
#include "study/fit/traits.hpp"

namespace thimble {

struct FitOptions {
    std::filesystem::path folder;  // trials.csv and trajectories/
    std::uint32_t subject = 1;
    std::optional<std::uint32_t> experiment{};  // its trials alone
    std::filesystem::path out;
    std::size_t simulations = 4000;  // trials
    std::uint64_t seed = 1;
    unsigned jobs = 0;  // threads; 0: one per core
    IfExists if_exists = IfExists::kRefuse;
    const std::atomic<bool>* stop = nullptr;
};

struct FitResult {
    std::vector<KeySummary> keys;
    std::size_t trials = 0, left_out = 0;  // of the recorded: used; without beep or without a feature
    // The last trial of each condition, predicted from the others: features, and those inside their 90 % interval.
    std::size_t held_out = 0, held_out_inside = 0;
    bool complete = true;  // false: stopped; what was simulated is kept
};

// The settings with which a participant's trials are simulated: a person's handle becomes the simulated one.
SystemSettings simulated_settings(SystemSettings settings);

// Writes simulations.csv (a line per pair of trials, as it ends), posterior.csv and fit.json below options.out. Throws Error: usage or
// data, naming the file or the trial that is missing. Usage also where [operator] has press_N or spread_experience, which no trait of a
// fit stands for.
FitResult run_fit(const SystemSettings& settings, const FitOptions& options);

// fit.json in the folder of a fit, or the file itself.
std::filesystem::path fit_file(const std::filesystem::path& fit);
// The medians of a fit, from its folder or its fit.json, as keys of a session file. Throws Error (data).
std::vector<SettingChange> read_fit(const std::filesystem::path& fit);
// As read_fit(), without spread between subjects: each subject is this person.
std::vector<SettingChange> twin_of(const std::filesystem::path& fit);

// How much delay the handle's loop bears in one fitted person's hand.

// Delays of the whole way round, up to which the loop is stable; infinite: any delay.
struct DelayBound {
    double stiffness_N_per_m = 0;  // of the fixture, at the handle
    double median_s = 0;           // arm and grip at the medians of the fit
    double least_s = 0;            // at the worst corner of their 90 % intervals
};

// The session's own fixture, then half of its stiffness, a quarter and so on to 1/64. Co-contraction and dry friction are left out, as in
// critical_delay.hpp. Empty for a session without a fixture. `settings` are the twin's, and `fit` was read before (twin_of).
std::vector<DelayBound> delay_bounds(const SystemSettings& settings, const std::filesystem::path& fit);

ReportTable bounds_table(const std::vector<DelayBound>& bounds);

}  // namespace thimble
