#include "session/records/mean_trajectory.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/csv/columns.hpp"
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

namespace {

using Curve = TrialCurve;
using C = TrialConditions;

constexpr std::array kLeading{column<Curve, &Curve::conditions, &C::experiment>("experiment"),
                              column<Curve, &Curve::conditions, &C::subject>("subject"),
                              column<Curve, &Curve::conditions, &C::trial>("trial"),
                              column<Curve, &Curve::conditions, &C::modality>("modality"),
                              column<Curve, &Curve::conditions, &C::delay_s>("delay_s"),
                              column<Curve, &Curve::entered>("entered"),
                              column<Curve, &Curve::beeped>("beeped")};

const std::vector<std::string>& column_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        list.reserve(std::size(kLeading) + 2 * curve_grid_percent().size());
        for (const auto& column : kLeading) list.emplace_back(column.name);
        for (const char* what : {"needle", "surface"}) {
            for (const double at : curve_grid_percent()) list.push_back(fmt::format("{}_{:g}%", what, at));
        }
        return list;
    }();
    return names;
}

void write_curve(fmt::memory_buffer& line, bool entered, const std::vector<double>& curve) {
    for (std::size_t i = 0; i < kCurvePoints; ++i) {
        line.push_back(',');
        if (entered) write_value(line, curve[i]);
    }
}

std::vector<double> read_curve(const CsvReader& reader, std::size_t first) {
    std::vector<double> curve(kCurvePoints);
    for (std::size_t i = 0; i < kCurvePoints; ++i) curve[i] = reader.field(first + i).number();
    return curve;
}

TrialCurve read_line(const CsvReader& reader) {
    TrialCurve trial;
    read_fields(reader, kLeading, trial);
    if (!trial.entered) return trial;
    trial.needle_percent = read_curve(reader, kLeading.size());
    trial.surface_percent = read_curve(reader, kLeading.size() + kCurvePoints);
    return trial;
}

}  // namespace

CurveFile::CurveFile(const std::filesystem::path& path, IfExists if_exists) : file_(path, if_exists) {
    if (file_.is_new()) file_.write(fmt::format("{}\n", fmt::join(column_names(), ",")));
    file_.flush();
}

void CurveFile::append(const TrialCurve& trial) {
    fmt::memory_buffer line;
    write_fields(line, kLeading, trial);
    write_curve(line, trial.entered, trial.needle_percent);
    write_curve(line, trial.entered, trial.surface_percent);
    line.push_back('\n');
    file_.write({line.data(), line.size()});
    file_.flush();
}

void read_curves(const std::filesystem::path& path, const TakeCurve& take, LastLine last) {
    const std::vector<std::string_view> names(column_names().begin(), column_names().end());
    CsvReader reader(path, names, ',', 0, last);
    while (reader.next()) take(read_line(reader));
}

}  // namespace thimble
