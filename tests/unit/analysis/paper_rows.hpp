// Rows of trials as the paper's experiments have them, from one value per modality.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "session/records/trial_table.hpp"

namespace thimble {

using PerModality = std::array<double, 4>;  // HF, CF, CCF, VF

// A spread over subjects and trials that is none of the modality's.
inline double ripple(std::uint32_t subject, std::uint32_t modality) {
    return std::sin(1.7 * subject) + 0.3 * std::sin(2.3 * subject + 1.1 * modality);
}

struct PaperRows {
    std::vector<TrialRow> rows;

    void add(std::uint32_t experiment, std::uint32_t subjects, const PerModality& penetration_m,
             const PerModality& time_s, double delay_s = 0) {
        for (std::uint32_t subject = 1; subject <= subjects; ++subject) {
            for (std::uint32_t m = 0; m < 4; ++m) {
                TrialRow row;
                row.conditions.experiment = experiment;
                row.conditions.subject = subject;
                row.conditions.modality = kModalities[m];
                row.conditions.delay_s = delay_s;
                row.reason = EndReason::kCompleted;
                row.metrics.penetration_mean_m = penetration_m[m] + 1e-4 * ripple(subject, m);
                row.metrics.penetration_max_m = penetration_m[m] * 1.1 + 1e-4 * ripple(subject, m);
                row.metrics.completion_time_s = time_s[m] + 0.1 * ripple(subject, m);
                row.metrics.oscillates = delay_s > 0 && m == 0;
                rows.push_back(row);
            }
        }
    }
    void add_removals(const PerModality& displacement_m) {
        for (std::uint32_t i = 0; i < 32; ++i) {
            TrialRow row;
            row.conditions.experiment = 2;
            row.conditions.subject = i / 2 + 1;
            row.conditions.modality = kModalities[i % 4];
            row.conditions.removes_fixture = true;
            row.reason = EndReason::kCompleted;
            row.metrics.peak_displacement_m = displacement_m[i % 4] + 1e-4 * ripple(i, 0);
            rows.push_back(row);
        }
    }
};

}  // namespace thimble
