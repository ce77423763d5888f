#include "experiment/study_columns.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

bool has_own_delay(const TrialRow& row) {
    return (row.conditions.delay_s > 0) == (row.conditions.experiment == 3);
}

}  // namespace

StudyColumns::StudyColumns(const std::vector<TrialRow>& rows, std::uint32_t experiment)
    : experiment_(experiment), rows_(of_experiment(rows, experiment)) {
    std::erase_if(rows_, [](const TrialRow& row) { return !has_own_delay(row) || !ran_to_its_end(row); });
    for (const TrialRow& row : rows_) subjects_.push_back(row.conditions.subject);
    std::sort(subjects_.begin(), subjects_.end());
    subjects_.erase(std::unique(subjects_.begin(), subjects_.end()), subjects_.end());
}

std::vector<NamedValues> StudyColumns::subject_means(Metric metric) const {
    std::vector<NamedValues> columns;
    columns.reserve(kModalities.size());
    for (const Modality modality : kModalities) columns.push_back(column(metric, modality));
    return columns;
}

CompleteRows StudyColumns::table(Metric metric) const { return complete_rows(subject_means(metric)); }

NamedValues StudyColumns::column(Metric metric, Modality modality) const {
    NamedValues column{to_string(modality), {}};
    for (const std::uint32_t subject : subjects_) {
        double sum = 0;
        int n = 0;
        for (const TrialRow& row : rows_) {
            if (row.conditions.subject != subject || row.conditions.modality != modality) continue;
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
    for (const Modality modality : kModalities) {
        NamedValues group{to_string(modality), {}};
        for (const TrialRow& row : rows_) {
            const double value = info(metric).value(row.metrics);
            if (row.conditions.modality == modality && !std::isnan(value)) group.values.push_back(value);
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

}  // namespace thimble
