// The posterior of one key of the operator in three numbers, and whether the trials say anything about it.
#pragma once

#include <span>
#include <string>

#include "study/fit/traits.hpp"

namespace thimble {

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
