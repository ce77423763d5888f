#include "experiment/mean_trajectory.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "common/time.hpp"

namespace thimble {

void CurveStatistics::add(double value_percent) {
    ++trials;
    const double before_percent = value_percent - mean_percent;
    mean_percent += before_percent / trials;
    squares_percent2 += before_percent * (value_percent - mean_percent);
}

double CurveStatistics::sd_percent() const {
    if (trials < 2) return std::numeric_limits<double>::quiet_NaN();
    return std::sqrt(squares_percent2 / (trials - 1));
}

MeanTrajectory::MeanTrajectory(std::size_t points) {
    assert(points >= 2);
    const double step_percent = (kCurveEnd_percent - kCurveBegin_percent) / static_cast<double>(points - 1);
    for (std::size_t i = 0; i < points; ++i) {
        curve_.time_percent.push_back(kCurveBegin_percent + static_cast<double>(i) * step_percent);
    }
    curve_.needle.resize(points);
    curve_.surface.resize(points);
    curve_.example_needle_percent.assign(points, std::numeric_limits<double>::quiet_NaN());
}

void MeanTrajectory::add(const TrialRecord& record) {
    const auto& samples = record.samples;
    const auto entry = std::find_if(samples.begin(), samples.end(), [](const TrajectorySample& sample) {
        return sample.phase == TissuePhase::kPenetrated;
    });
    const bool beeped = std::isfinite(record.beep_time_s);
    const double span_s =
        entry == samples.end() ? 0 : (beeped ? record.beep_time_s : samples.back().time_s) - entry->time_s;
    if (!(span_s > 0)) {
        ++curve_.trials_without_entry;
        return;
    }
    const bool first = curve_.trials() == 0;
    ++(beeped ? curve_.trials_with_beep : curve_.trials_without_beep);

    const double to_percent = 100 / record.conditions.fixture_position_m;
    auto after = samples.begin() + 1;
    for (std::size_t i = 0; i < curve_.time_percent.size(); ++i) {
        const double time_s = entry->time_s + span_s * curve_.time_percent[i] / 100;
        while (after != samples.end() && after->time_s < time_s) ++after;
        if (after == samples.end()) break;
        const auto before = after - 1;
        if (before->time_s > time_s) continue;  // the trial has not begun
        const double step_s = after->time_s - before->time_s;
        const double part = step_s > 0 ? (time_s - before->time_s) / step_s : 0;
        const auto between = [&](double TrajectorySample::*position) {
            const double from_m = (*before).*position;
            return to_percent * (from_m + part * ((*after).*position - from_m));
        };
        const double needle_percent = between(&TrajectorySample::position_needle_m);
        curve_.needle[i].add(needle_percent);
        curve_.surface[i].add(between(&TrajectorySample::position_surface_m));
        if (first) curve_.example_needle_percent[i] = needle_percent;
    }
}

void TrajectoryPanels::add(const TrialRecord& record) {
    const TrialConditions& conditions = record.conditions;
    const auto same = [&](const TrajectoryPanel& panel) {
        return panel.modality == conditions.modality &&
               from_seconds(panel.delay_s) == from_seconds(conditions.delay_s);
    };
    auto panel = std::find_if(panels_.begin(), panels_.end(), same);
    if (panel == panels_.end()) {
        panels_.push_back({conditions.modality, conditions.delay_s, MeanTrajectory{}});
        panel = panels_.end() - 1;
    }
    panel->mean.add(record);
}

}  // namespace thimble
