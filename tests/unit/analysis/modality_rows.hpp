// Rows of trials made from one value per subject and modality, the same for every measure.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "analysis/statistics/distributions.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

using Columns = std::array<std::vector<double>, 4>;  // HF, CF, CCF, VF; NaN: no trial of that subject

inline TrialRow row_of(std::uint32_t experiment, std::uint32_t subject, std::size_t modality, double value) {
    TrialRow row;
    row.conditions.experiment = experiment;
    row.conditions.subject = subject;
    row.conditions.modality = kModalities[modality];
    row.conditions.delay_s = experiment == 3 ? 0.05 : 0;
    row.reason = EndReason::kCompleted;
    row.metrics.penetration_mean_m = value;
    row.metrics.penetration_max_m = value;
    row.metrics.completion_time_s = 1e3 * value;
    row.metrics.peak_displacement_m = value;
    row.metrics.first_contact_time_s = 1;
    return row;
}

inline std::vector<TrialRow> rows_of(const Columns& columns, std::uint32_t experiment = 1) {
    std::vector<TrialRow> rows;
    for (std::size_t m = 0; m < columns.size(); ++m) {
        for (std::size_t s = 0; s < columns[m].size(); ++s) {
            if (std::isnan(columns[m][s])) continue;
            rows.push_back(row_of(experiment, static_cast<std::uint32_t>(s + 1), m, columns[m][s]));
        }
    }
    return rows;
}

// As normal as a column can be: the quantiles of a normal distribution, in an order of its own per modality.
// Passes every test of normality.
inline Columns normal_columns(std::size_t subjects, const std::array<double, 4>& means_m,
                              double sd_m = 1e-4) {
    constexpr std::array<std::size_t, 4> kStride{11, 13, 17,
                                                 19};  // each visits every place of up to 10, and of 16
    Columns columns;
    for (std::size_t m = 0; m < columns.size(); ++m) {
        for (std::size_t s = 0; s < subjects; ++s) {
            const std::size_t place = (s * kStride[m] + 5 * m) % subjects;
            const double p = (static_cast<double>(place) + 0.5) / static_cast<double>(subjects);
            columns[m].push_back(means_m[m] + sd_m * normal_quantile(p));
        }
    }
    return columns;
}

}  // namespace thimble
