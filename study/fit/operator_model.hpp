// The virtual operator as a fit uses it: simulated trials of drawn people, an emulator per condition, and the posterior of one
// person's traits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "session/records/trial_record.hpp"
#include "session/settings/system_settings.hpp"
#include "study/fit/emulator.hpp"

namespace thimble {

// A recorded trial, or a simulated one of the person whose traits are sought.
struct ObservedTrial {
    TrialConditions conditions;
    TrialFeatures features{};
};

// Trials of one modality at one delay.
struct FitGroup {
    Modality modality = Modality::kHF;
    double delay_s = 0;
    std::vector<TrialConditions> trials;

    bool has(const TrialConditions& conditions) const;
};
std::vector<FitGroup> fit_groups(std::span<const TrialConditions> trials);

// Pair i of the trials from which a model learns: group after group, each of another person of the population, under the conditions of two
// of the recorded trials in turn. People of different seeds are different.
std::array<TrialConditions, 2> training_pair(std::span<const FitGroup> groups, std::uint64_t seed,
                                             std::size_t i);
// Runs the pair. None if one trial lacks a feature.
std::optional<SimulatedPair> simulate_pair(const SystemSettings& settings,
                                           const std::array<TrialConditions, 2>& pair);

std::optional<TrialFeatures> simulate_trial(const SystemSettings& settings,
                                            const TrialConditions& conditions);
TraitScores traits_of(const SystemSettings& settings, const TrialConditions& conditions);

class OperatorModel {
  public:
    // Pair i of `training` is that of training_pair(groups, seed, i). Throws Error (run failed) if a group has too few, or all alike.
    OperatorModel(const OperatorParameters& population, std::vector<FitGroup> groups,
                  std::span<const std::optional<SimulatedPair>> training);

    const std::vector<FitGroup>& groups() const { return groups_; }
    // `draws` of the posterior, given all these trials. A pure function of its arguments.
    std::vector<TraitScores> posterior(std::span<const ObservedTrial> trials, std::uint64_t seed,
                                       std::size_t draws) const;
    // Of the features of `trial`: how many lie within the central 90 % of what the draws predict.
    std::size_t predicted(const ObservedTrial& trial, std::span<const TraitScores> draws,
                          std::uint64_t seed) const;

  private:
    std::size_t group_of(const TrialConditions& conditions) const;

    std::vector<FitGroup> groups_;
    std::vector<Emulator> emulators_;
};

// Draws of the posterior of standard normal traits. I. Murray, R. P. Adams and D. J. C. MacKay, "Elliptical slice sampling", AISTATS
// 2010; about the normal distribution that earlier draws of the same chain suggest, so that each draw forgets the one before.
std::vector<TraitScores> slice_samples(const std::function<double(const TraitScores&)>& log_likelihood,
                                       std::uint64_t seed, std::size_t draws);

// The trials of one participant, as a run or a study left them, for a fit.
struct RecordedTrials {
    std::vector<ObservedTrial> trials;
    std::size_t left_out = 0;  // without a beep, or without a feature
};

// From trials.csv and trajectories/ of `folder`, of all experiments or of one; trials whose fixture vanishes are not counted. Throws
// Error (data) where a file is missing, the participant has no trial, or a condition fewer than two. Likewise where experiments have
// other people under the same number.
RecordedTrials recorded_trials(const std::filesystem::path& folder, std::uint32_t subject,
                               std::optional<std::uint32_t> experiment = {});

}  // namespace thimble
