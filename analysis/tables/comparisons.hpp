// How far each two conditions of one experiment and delay differ in a measure. One procedure per comparison: estimate, interval
// and P come from the same rank test (location_shift.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics/location_shift.hpp"
#include "analysis/tables/study_columns.hpp"

namespace thimble {

// Of P; intervals hold with 1 minus it. Both are for all pairs of one measure and group at once (Bonferroni).
inline constexpr double kFindingLevel = 0.05;

struct ConditionPair {
    Metric metric = Metric::kPenetrationMean;
    std::string first, second;
    std::size_t n = 0;                   // subjects with both; of independent trials: trials of both together
    std::size_t subjects = 0;            // of those
    std::size_t family = 1;              // pairs compared at once
    bool paired = true;                  // false: independent trials (experiment 2)
    std::optional<LocationShift> shift;  // nothing if n is 0

    bool can_be_judged() const { return shift && shift->interval; }
    bool apart() const { return can_be_judged() && shift->p < kFindingLevel; }
    std::size_t fewest() const;  // subjects, or trials of each condition, with which it can be judged
};

// Every pair of conditions that have the measure. A subject without it in one of the two is left out of that pair only.
std::vector<ConditionPair> compare_conditions(const StudyColumns& columns, Metric metric);

}  // namespace thimble
