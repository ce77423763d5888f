// The traits that a fit estimates, and the keys of a session file that they decide. Each virtual subject draws its traits as
// independent standard normal numbers.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "master/operator/operator_parameters.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// A trait is median * exp(spread * z). Its z has the standard normal distribution in the population.
inline constexpr std::size_t kTraitCount = 11;
using TraitScores = std::array<double, kTraitCount>;

// The scores of a drawn subject. A trait without spread has 0.
TraitScores trait_scores(const OperatorParameters& population, const Subject& subject);

// The traits that can do something in the trials of this modality.
std::vector<std::size_t> acting_traits(const OperatorParameters& population, Modality modality);

struct FittedKey {
    std::string key;       // "operator.reaction_visual_s"
    double median = 0;     // of the population
    TraitScores spread{};  // log(value / median) = sum of spread * z

    double value(const TraitScores& scores) const;
    double spread_of_logarithm() const;  // in the population
};

// Every key of [operator] that differs between subjects.
std::vector<FittedKey> fitted_keys(const OperatorParameters& population);

// Keys that give each subject the medians: each spread is 0.
std::vector<SettingChange> without_spread();

// The posterior of one key of the operator in three numbers, and whether the trials say anything about it.

// A key whose spread the trials reduce by less than this share is not identifiable from them.
inline constexpr double kIdentifiableFrom = 0.2;

struct KeySummary {
    std::string key;
    double median = 0, low = 0, high = 0;  // 90 % interval
    double population_low = 0, population_high = 0;
    double narrowed = 0;  // 1 - SD of the logarithm over that of the population

    bool identifiable() const { return narrowed >= kIdentifiableFrom; }
};

KeySummary summarise(const FittedKey& key, std::span<const TraitScores> draws);

}  // namespace thimble
