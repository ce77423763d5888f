#include "study/fit/operator_model.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/math/portable.hpp"
#include "common/random.hpp"
#include "session/records/condition_summary.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {
namespace {

// Beyond every virtual subject that a session can have.
constexpr std::uint32_t kFirstSimulatedSubject = 2'000'000;
// Streams of a fit: other than those of joint draws, which have experiment 0.
constexpr std::uint32_t kPrediction = 2;

}  // namespace

bool FitGroup::has(const TrialConditions& conditions) const {
    return conditions.modality == modality && same_delay(conditions.delay_s, delay_s);
}

std::vector<FitGroup> fit_groups(std::span<const TrialConditions> trials) {
    std::vector<FitGroup> groups;
    for (const TrialConditions& trial : trials) {
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const FitGroup& known) { return known.has(trial); });
        if (group == groups.end())
            group = groups.insert(groups.end(), FitGroup{trial.modality, trial.delay_s, {}});
        group->trials.push_back(trial);
    }
    return groups;
}

std::array<TrialConditions, 2> training_pair(std::span<const FitGroup> groups, std::uint64_t seed,
                                             std::size_t i) {
    const std::vector<TrialConditions>& trials = groups[i % groups.size()].trials;
    const std::size_t first = 2 * (i / groups.size());
    std::array<TrialConditions, 2> pair{trials[first % trials.size()], trials[(first + 1) % trials.size()]};
    for (TrialConditions& conditions : pair) {
        conditions.study_seed = seed;
        conditions.subject = kFirstSimulatedSubject + static_cast<std::uint32_t>(i);
    }
    return pair;
}

std::optional<TrialFeatures> simulate_trial(const SystemSettings& settings,
                                            const TrialConditions& conditions) {
    const TrialRecord record = run_virtual_trial(settings, conditions);
    return trial_features(record.samples, conditions.fixture_position_m, record.beep_time_s);
}

TraitScores traits_of(const SystemSettings& settings, const TrialConditions& c) {
    return trait_scores(settings.person,
                        draw_subject(settings.person, c.study_seed, c.experiment, c.subject));
}

std::optional<SimulatedPair> simulate_pair(const SystemSettings& settings,
                                           const std::array<TrialConditions, 2>& pair) {
    const auto first = simulate_trial(settings, pair[0]);
    if (!first) return std::nullopt;
    const auto second = simulate_trial(settings, pair[1]);
    if (!second) return std::nullopt;
    return SimulatedPair{traits_of(settings, pair[0]), *first, *second};
}

OperatorModel::OperatorModel(const OperatorParameters& population, std::vector<FitGroup> groups,
                             std::span<const std::optional<SimulatedPair>> training)
    : groups_(std::move(groups)) {
    emulators_.reserve(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        std::vector<SimulatedPair> own;
        own.reserve(training.size() / groups_.size() + 1);
        for (std::size_t i = g; i < training.size(); i += groups_.size())
            if (training[i]) own.push_back(*training[i]);
        emulators_.emplace_back(own, acting_traits(population, groups_[g].modality));
    }
}

std::size_t OperatorModel::group_of(const TrialConditions& conditions) const {
    const auto found = std::find_if(groups_.begin(), groups_.end(),
                                    [&](const FitGroup& group) { return group.has(conditions); });
    return static_cast<std::size_t>(found - groups_.begin());
}

std::vector<TraitScores> OperatorModel::posterior(std::span<const ObservedTrial> trials, std::uint64_t seed,
                                                  std::size_t draws) const {
    std::vector<FeatureMean> means(groups_.size());
    for (const ObservedTrial& trial : trials) means.at(group_of(trial.conditions)).add(trial.features);
    std::vector<std::optional<Cholesky>> covariances(groups_.size());
    for (std::size_t g = 0; g < means.size(); ++g)
        if (means[g].trials > 0) covariances[g] = emulators_[g].covariance(means[g].trials);
    const auto log_likelihood = [&](const TraitScores& traits) {
        double sum = 0;
        for (std::size_t g = 0; g < means.size(); ++g)
            if (covariances[g]) sum += emulators_[g].log_likelihood(traits, means[g], *covariances[g]);
        return sum;
    };
    return slice_samples(log_likelihood, seed, draws);
}

std::size_t OperatorModel::predicted(const ObservedTrial& trial, std::span<const TraitScores> draws,
                                     std::uint64_t seed) const {
    RandomStream random({seed, kPrediction, 0, 0, Purpose::kParameter});
    const Emulator& emulator = emulators_.at(group_of(trial.conditions));
    const Cholesky covariance = emulator.covariance(1);
    std::array<std::size_t, kFeatureNames.size()> below{};
    for (const TraitScores& traits : draws) {
        TrialFeatures normals{};
        for (double& normal : normals) normal = random.normal();
        const TrialFeatures drawn = emulator.predict(traits, normals, covariance);
        for (std::size_t k = 0; k < below.size(); ++k) below[k] += drawn[k] < trial.features[k];
    }
    const auto n = static_cast<double>(draws.size());
    return static_cast<std::size_t>(std::count_if(below.begin(), below.end(), [n](std::size_t count) {
        const double share = static_cast<double>(count) / n;
        return share >= 0.05 && share <= 0.95;
    }));
}

}  // namespace thimble
