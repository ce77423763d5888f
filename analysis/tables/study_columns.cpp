#include "analysis/tables/study_columns.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace thimble {
namespace {

bool has_own_delay(const TrialRow& row) {
    return (row.conditions.delay_s > 0) == (row.conditions.experiment == 3);
}

// In the order of their names. Empty if there is no trial of this modality.
std::vector<Compensator> compensators_of(const std::vector<TrialRow>& rows, Modality modality) {
    std::vector<Compensator> compensators;
    for (const TrialRow& row : rows) {
        if (row.conditions.modality == modality) compensators.push_back(row.conditions.compensator);
    }
    std::sort(compensators.begin(), compensators.end());
    compensators.erase(std::unique(compensators.begin(), compensators.end()), compensators.end());
    if (compensators.empty()) compensators.push_back(Compensator::kNone);
    return compensators;
}

std::string name_of(Modality modality, Compensator compensator, bool several) {
    std::string name = to_string(modality);
    if (several && compensator != Compensator::kNone) {
        name += '+';
        name += kCompensatorNames[static_cast<std::size_t>(compensator)];
    }
    return name;
}

}  // namespace

StudyColumns::StudyColumns(const std::vector<TrialRow>& rows, std::uint32_t experiment,
                           std::optional<double> delay_s)
    : experiment_(experiment), rows_(of_experiment(rows, experiment)) {
    std::erase_if(rows_, [&](const TrialRow& row) {
        const bool at_delay = delay_s ? same_delay(row.conditions.delay_s, *delay_s) : has_own_delay(row);
        return !at_delay || !ran_to_its_end(row);
    });
    for (const TrialRow& row : rows_) subjects_.push_back(row.conditions.subject);
    std::sort(subjects_.begin(), subjects_.end());
    subjects_.erase(std::unique(subjects_.begin(), subjects_.end()), subjects_.end());
    conditions_.reserve(kModalities.size() + kCompensatorNames.size());
    for (const Modality modality : kModalities) {
        const std::vector<Compensator> compensators = compensators_of(rows_, modality);
        for (const Compensator compensator : compensators) {
            conditions_.push_back(
                {modality, compensator, name_of(modality, compensator, compensators.size() > 1)});
        }
    }
}

bool StudyColumns::is_of(const TrialRow& row, const Condition& condition) const {
    return row.conditions.modality == condition.modality &&
           row.conditions.compensator == condition.compensator;
}

std::vector<TrialRow> StudyColumns::rows_of(const Condition& condition) const {
    std::vector<TrialRow> rows;
    std::copy_if(rows_.begin(), rows_.end(), std::back_inserter(rows),
                 [&](const TrialRow& row) { return is_of(row, condition); });
    return rows;
}

std::vector<NamedValues> StudyColumns::subject_means(Metric metric) const {
    std::vector<NamedValues> columns;
    columns.reserve(conditions_.size());
    for (const Condition& condition : conditions_) columns.push_back(column(metric, condition));
    return columns;
}

CompleteRows StudyColumns::table(Metric metric) const { return complete_rows(subject_means(metric)); }

NamedValues StudyColumns::column(Metric metric, Modality modality) const {
    return column(metric,
                  *std::find_if(conditions_.begin(), conditions_.end(),
                                [&](const Condition& condition) { return condition.modality == modality; }));
}

NamedValues StudyColumns::column(Metric metric, const Condition& condition) const {
    NamedValues column{condition.name, {}};
    for (const std::uint32_t subject : subjects_) {
        double sum = 0;
        int n = 0;
        for (const TrialRow& row : rows_) {
            if (row.conditions.subject != subject || !is_of(row, condition)) continue;
            const double value = info(metric).value(row.metrics);
            if (std::isnan(value)) continue;
            sum += value;
            ++n;
        }
        column.values.push_back(n > 0 ? sum / n : std::nan(""));
    }
    return column;
}

std::vector<NamedValues> StudyColumns::groups(Metric metric) const {
    std::vector<NamedValues> groups;
    for (const Condition& condition : conditions_) {
        NamedValues group{condition.name, {}};
        for (const TrialRow& row : rows_) {
            const double value = info(metric).value(row.metrics);
            if (is_of(row, condition) && !std::isnan(value)) group.values.push_back(value);
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

std::vector<Metric> measures_of(std::uint32_t experiment) {
    if (experiment == 2) return {Metric::kPeakDisplacement};
    return {Metric::kPenetrationMean, Metric::kPenetrationMax, Metric::kCompletionTime};
}

}  // namespace thimble
