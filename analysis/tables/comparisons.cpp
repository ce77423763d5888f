#include "analysis/tables/comparisons.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace thimble {
namespace {

ConditionPair paired_comparison(ConditionPair comparison, const NamedValues& first,
                                const NamedValues& second) {
    NamedValues differences{fmt::format("{} - {}", first.name, second.name), {}};
    for (std::size_t s = 0; s < first.values.size(); ++s) {
        const double difference = first.values[s] - second.values[s];
        if (!std::isnan(difference)) differences.values.push_back(difference);
    }
    comparison.n = comparison.subjects = differences.values.size();
    if (comparison.n > 0) comparison.shift = signed_rank(differences, comparison.family, kFindingLevel);
    return comparison;
}

std::size_t subjects_of(const StudyColumns& columns, Metric metric, const std::string& first,
                        const std::string& second) {
    std::set<std::uint32_t> subjects;
    for (const StudyColumns::Condition& condition : columns.conditions()) {
        if (condition.name != first && condition.name != second) continue;
        for (const TrialRow& row : columns.rows_of(condition)) {
            if (!std::isnan(info(metric).value(row.metrics))) subjects.insert(row.conditions.subject);
        }
    }
    return subjects.size();
}

// Of experiment 2: each trial another subject's or modality's.
ConditionPair independent_comparison(ConditionPair comparison, const StudyColumns& columns,
                                     const NamedValues& first, const NamedValues& second) {
    comparison.paired = false;
    comparison.n = first.values.size() + second.values.size();
    comparison.subjects = subjects_of(columns, comparison.metric, first.name, second.name);
    comparison.shift = rank_sum(first, second, comparison.family, kFindingLevel);
    return comparison;
}

bool has_values(const NamedValues& column) {
    return std::any_of(column.values.begin(), column.values.end(),
                       [](double value) { return !std::isnan(value); });
}

}  // namespace

std::size_t ConditionPair::fewest() const {
    return paired ? fewest_for_signed_rank(family, kFindingLevel)
                  : fewest_for_rank_sum(family, kFindingLevel);
}

std::vector<ConditionPair> compare_conditions(const StudyColumns& columns, Metric metric) {
    const bool paired = columns.experiment() != 2;
    std::vector<NamedValues> values = paired ? columns.subject_means(metric) : columns.groups(metric);
    std::erase_if(values, [](const NamedValues& column) { return !has_values(column); });
    std::vector<ConditionPair> comparisons;
    const std::size_t pairs = values.empty() ? 0 : values.size() * (values.size() - 1) / 2;
    for (std::size_t a = 0; a < values.size(); ++a) {
        for (std::size_t b = a + 1; b < values.size(); ++b) {
            ConditionPair blank{metric, values[a].name, values[b].name, 0, 0, pairs, paired, {}};
            comparisons.push_back(
                paired ? paired_comparison(std::move(blank), values[a], values[b])
                       : independent_comparison(std::move(blank), columns, values[a], values[b]));
        }
    }
    return comparisons;
}

}  // namespace thimble
