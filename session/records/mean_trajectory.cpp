#include "session/records/mean_trajectory.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/csv/columns.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {

namespace {

// The two events that a curve shows, and the axis between them.
struct CurveClock {
    double entry_s = TrialCurve::kNone, contact_s = TrialCurve::kNone, end_s = TrialCurve::kNone;

    explicit CurveClock(const TrialRecord& record)
        : end_s(std::isfinite(record.beep_time_s) || record.samples.empty() ? record.beep_time_s
                                                                            : record.samples.back().time_s) {
        const double fixture_m = record.conditions.fixture_position_m;
        for (const TrajectorySample& sample : record.samples) {
            if (std::isnan(entry_s) && sample.phase == TissuePhase::kPenetrated) entry_s = sample.time_s;
            const bool touches = sample.fixture_present && sample.position_needle_m > fixture_m;
            if (std::isnan(contact_s) && touches) contact_s = sample.time_s;
        }
    }
    bool places(CurveAxis axis) const {
        return axis == CurveAxis::kFromContact ? std::isfinite(contact_s) : end_s > entry_s;
    }
    double span_s(CurveAxis axis) const {
        return axis == CurveAxis::kFromContact ? 1 : (end_s - entry_s) / 100;
    }
    double origin_s(CurveAxis axis) const { return axis == CurveAxis::kFromContact ? contact_s : entry_s; }
};

// Follows a trial's samples forward and reads between them.
class CurveReader {
  public:
    explicit CurveReader(const TrialRecord& record)
        : samples_(record.samples),
          rest_m_(samples_.front().position_surface_m),
          to_percent_(100 / (record.conditions.fixture_position_m - rest_m_)) {}

    // False: there are no samples on both sides of it. Times do not fall from call to call.
    bool go_to(double time_s) {
        while (after_ < samples_.size() && samples_[after_].time_s < time_s) ++after_;
        if (after_ == samples_.size() || samples_[after_ - 1].time_s > time_s) return false;
        const double step_s = samples_[after_].time_s - samples_[after_ - 1].time_s;
        part_ = step_s > 0 ? (time_s - samples_[after_ - 1].time_s) / step_s : 0;
        return true;
    }
    double percent(double TrajectorySample::*position) const {
        const double from_m = samples_[after_ - 1].*position;
        const double at_m = from_m + part_ * (samples_[after_].*position - from_m);
        return std::round(to_percent_ * (at_m - rest_m_) * 1000) / 1000;
    }

  private:
    std::span<const TrajectorySample> samples_;
    double rest_m_, to_percent_;
    std::size_t after_ = 1;
    double part_ = 0;
};

CurveSums empty_sums(std::size_t points) {
    return {std::vector<CurveStatistics>(points), std::vector<CurveStatistics>(points), {}, {}};
}

void add_number(CurveStatistics& statistics, double value) {
    if (!std::isnan(value)) statistics.add(value);
}

void add_trial(CurveSums& sums, const TrialCurve& trial) {
    for (std::size_t i = 0; i < trial.needle_percent.size(); ++i) {
        add_number(sums.needle[i], trial.needle_percent[i]);
        add_number(sums.surface[i], trial.surface_percent[i]);
    }
    add_number(sums.entry, trial.entry);
    add_number(sums.beep, trial.beep);
}

// The means of one subject.
void add_subject(CurveSums& sums, const CurveSums& subject) {
    const auto add = [](CurveStatistics& to, const CurveStatistics& from) {
        if (from.n > 0) to.add(from.mean);
    };
    for (std::size_t i = 0; i < subject.needle.size(); ++i) {
        add(sums.needle[i], subject.needle[i]);
        add(sums.surface[i], subject.surface[i]);
    }
    add(sums.entry, subject.entry);
    add(sums.beep, subject.beep);
}

}  // namespace

void CurveStatistics::add(double value) {
    ++n;
    const double before = value - mean;
    mean += before / n;
    squares += before * (value - mean);
}

double CurveStatistics::sd() const {
    if (n < 2) return TrialCurve::kNone;
    return std::sqrt(squares / (n - 1));
}

TrialCurve trial_curve(const TrialRecord& record, const CurveGrid& grid) {
    TrialCurve curve{record.conditions,
                     false,
                     std::isfinite(record.beep_time_s),
                     TrialCurve::kNone,
                     TrialCurve::kNone,
                     {},
                     {}};
    const CurveClock clock(record);
    curve.placed = clock.places(grid.axis);
    if (!curve.placed) return curve;
    const double origin_s = clock.origin_s(grid.axis), span_s = clock.span_s(grid.axis);
    curve.entry = (clock.entry_s - origin_s) / span_s;
    curve.beep = (clock.end_s - origin_s) / span_s;
    curve.needle_percent.assign(grid.points, TrialCurve::kNone);
    curve.surface_percent.assign(grid.points, TrialCurve::kNone);
    CurveReader reader(record);
    for (std::size_t i = 0; i < grid.points; ++i) {
        if (!reader.go_to(origin_s + span_s * grid.at(i))) continue;
        curve.needle_percent[i] = reader.percent(&TrajectorySample::position_needle_m);
        curve.surface_percent[i] = reader.percent(&TrajectorySample::position_surface_m);
    }
    return curve;
}

MeanTrajectory::MeanTrajectory(const CurveGrid& grid)
    : of_subject_(empty_sums(grid.points)), of_earlier_(empty_sums(grid.points)) {
    counts_.grid = grid;
    counts_.example_needle_percent.assign(grid.points, TrialCurve::kNone);
}

void MeanTrajectory::add(const TrialCurve& trial) {
    if (!trial.placed) {
        ++counts_.trials_left_out;
        return;
    }
    assert(trial.needle_percent.size() == counts_.grid.points);
    if (counts_.trials() == 0) counts_.example_needle_percent = trial.needle_percent;
    if (counts_.trials() == 0 || trial.conditions.subject != subject_) {
        add_subject(of_earlier_, of_subject_);
        of_subject_ = empty_sums(counts_.grid.points);
        subject_ = trial.conditions.subject;
        ++counts_.subjects;
    }
    ++(trial.beeped ? counts_.trials_with_beep : counts_.trials_without_beep);
    add_trial(of_subject_, trial);
}

MeanCurve MeanTrajectory::curve() const {
    MeanCurve curve = counts_;
    curve.mean = counts_.subjects > 1 ? of_earlier_ : of_subject_;
    if (counts_.subjects > 1) add_subject(curve.mean, of_subject_);
    return curve;
}

void TrajectoryPanels::add(const TrialCurve& trial) {
    const TrialConditions& conditions = trial.conditions;
    auto panel = find_condition(panels_, conditions.modality, conditions.delay_s);
    if (panel == panels_.end()) {
        panels_.push_back({conditions.modality, conditions.delay_s, MeanTrajectory(grid_)});
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
                              column<Curve, &Curve::placed>("placed"),
                              column<Curve, &Curve::beeped>("beeped"),
                              column<Curve, &Curve::entry>("entry"),
                              column<Curve, &Curve::beep>("beep")};

std::vector<std::string> column_names(const CurveGrid& grid) {
    std::vector<std::string> names;
    names.reserve(std::size(kLeading) + 2 * grid.points);
    for (const auto& column : kLeading) names.emplace_back(column.name);
    const char* unit = grid.axis == CurveAxis::kFromContact ? "s" : "%";
    for (const char* what : {"needle", "surface"})
        for (std::size_t i = 0; i < grid.points; ++i)
            names.push_back(fmt::format("{}_{:g}{}", what, grid.at(i), unit));
    return names;
}

std::string curve_header(const CurveGrid& grid) {
    return fmt::format("{}\n", fmt::join(column_names(grid), ","));
}

void write_curve(fmt::memory_buffer& line, bool placed, const std::vector<double>& curve,
                 std::size_t points) {
    for (std::size_t i = 0; i < points; ++i) {
        line.push_back(',');
        if (placed) write_value(line, curve[i]);
    }
}

std::vector<double> read_curve(const CsvReader& reader, std::size_t first, std::size_t points) {
    std::vector<double> curve(points);
    for (std::size_t i = 0; i < points; ++i) curve[i] = reader.field(first + i).number();
    return curve;
}

TrialCurve read_line(const CsvReader& reader, std::size_t points) {
    TrialCurve trial;
    read_fields(reader, kLeading, trial);
    if (!trial.placed) return trial;
    trial.needle_percent = read_curve(reader, kLeading.size(), points);
    trial.surface_percent = read_curve(reader, kLeading.size() + points, points);
    return trial;
}

}  // namespace

CurveFile::CurveFile(const std::filesystem::path& path, IfExists if_exists, const CurveGrid& grid)
    : file_(path, if_exists, curve_header(grid)), points_(grid.points) {
    if (file_.is_new()) file_.write(curve_header(grid));
    file_.flush();
}

void CurveFile::append(const TrialCurve& trial) {
    fmt::memory_buffer line;
    write_fields(line, kLeading, trial);
    write_curve(line, trial.placed, trial.needle_percent, points_);
    write_curve(line, trial.placed, trial.surface_percent, points_);
    line.push_back('\n');
    file_.write({line.data(), line.size()});
    file_.flush();
}

void read_curves(const std::filesystem::path& path, const TakeCurve& take, LastLine last,
                 const CurveGrid& grid) {
    const std::vector<std::string> columns = column_names(grid);
    const std::vector<std::string_view> names(columns.begin(), columns.end());
    CsvReader reader(path, names, ',', 0, last);
    while (reader.next()) take(read_line(reader, grid.points));
}

}  // namespace thimble
