#include "session/records/mean_trajectory.hpp"

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

std::vector<double> curve_grid_percent(std::size_t points) {
    assert(points >= 2);
    const double step_percent = (kCurveEnd_percent - kCurveBegin_percent) / static_cast<double>(points - 1);
    std::vector<double> grid;
    for (std::size_t i = 0; i < points; ++i) {
        grid.push_back(kCurveBegin_percent + static_cast<double>(i) * step_percent);
    }
    return grid;
}

TrialCurve trial_curve(const TrialRecord& record, std::size_t points) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const auto& samples = record.samples;
    const auto entry = std::find_if(samples.begin(), samples.end(), [](const TrajectorySample& sample) {
        return sample.phase == TissuePhase::kPenetrated;
    });
    TrialCurve curve{record.conditions, false, std::isfinite(record.beep_time_s), {}, {}};
    const double end_s = curve.beeped || samples.empty() ? record.beep_time_s : samples.back().time_s;
    curve.entered = entry != samples.end() && end_s > entry->time_s;
    if (!curve.entered) return curve;
    curve.needle_percent.assign(points, kNone);
    curve.surface_percent.assign(points, kNone);

    const std::vector<double> grid = curve_grid_percent(points);
    const double span_s = end_s - entry->time_s;
    const double to_percent = 100 / record.conditions.fixture_position_m;
    auto after = samples.begin() + 1;
    for (std::size_t i = 0; i < points; ++i) {
        const double time_s = entry->time_s + span_s * grid[i] / 100;
        while (after != samples.end() && after->time_s < time_s) ++after;
        if (after == samples.end()) break;
        const auto before = after - 1;
        if (before->time_s > time_s) continue;  // the trial has not begun
        const double step_s = after->time_s - before->time_s;
        const double part = step_s > 0 ? (time_s - before->time_s) / step_s : 0;
        const auto between = [&](double TrajectorySample::*position) {
            const double from_m = (*before).*position;
            const double percent = to_percent * (from_m + part * ((*after).*position - from_m));
            return std::round(percent * 1000) / 1000;
        };
        curve.needle_percent[i] = between(&TrajectorySample::position_needle_m);
        curve.surface_percent[i] = between(&TrajectorySample::position_surface_m);
    }
    return curve;
}

MeanTrajectory::MeanTrajectory(std::size_t points) {
    curve_.time_percent = curve_grid_percent(points);
    curve_.needle.resize(points);
    curve_.surface.resize(points);
    curve_.example_needle_percent.assign(points, std::numeric_limits<double>::quiet_NaN());
}

void MeanTrajectory::add(const TrialCurve& trial) {
    if (!trial.entered) {
        ++curve_.trials_without_entry;
        return;
    }
    assert(trial.needle_percent.size() == curve_.time_percent.size());
    if (curve_.trials() == 0) curve_.example_needle_percent = trial.needle_percent;
    ++(trial.beeped ? curve_.trials_with_beep : curve_.trials_without_beep);
    for (std::size_t i = 0; i < curve_.time_percent.size(); ++i) {
        if (std::isnan(trial.needle_percent[i])) continue;
        curve_.needle[i].add(trial.needle_percent[i]);
        curve_.surface[i].add(trial.surface_percent[i]);
    }
}

void TrajectoryPanels::add(const TrialCurve& trial) {
    const TrialConditions& conditions = trial.conditions;
    const auto same = [&](const TrajectoryPanel& panel) {
        return panel.modality == conditions.modality &&
               from_seconds(panel.delay_s) == from_seconds(conditions.delay_s);
    };
    auto panel = std::find_if(panels_.begin(), panels_.end(), same);
    if (panel == panels_.end()) {
        panels_.push_back({conditions.modality, conditions.delay_s, MeanTrajectory{}});
        panel = panels_.end() - 1;
    }
    panel->mean.add(trial);
}

}  // namespace thimble
