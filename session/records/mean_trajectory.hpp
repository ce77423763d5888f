// Mean and standard deviation of needle and tissue surface over subjects, on a common axis. The paper's (section IV-A): seconds from the
// needle's first entry into the fixture; depth in percent, 0 % the surface at rest, 100 % the trial's own fixture. Trials are added one by
// one and not kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

// Time in seconds from the first contact with the fixture; or in percent from the puncture of the tissue (0 %) to the beep (100 %). The
// latter stretches each trial, and so smears an oscillation.
enum class CurveAxis : std::uint8_t { kFromContact, kEntryToBeep };
inline constexpr std::array<std::string_view, 2> kCurveAxisNames{"contact", "percent"};

// Points of an axis, evenly spaced from `begin` to `end`, in its unit.
struct CurveGrid {
    CurveAxis axis = CurveAxis::kFromContact;
    double begin = -8, end = 14;
    std::size_t points = 881;  // at least two

    double at(std::size_t i) const {
        return begin + static_cast<double>(i) * (end - begin) / static_cast<double>(points - 1);
    }
};
inline constexpr CurveGrid kContactGrid{};
inline constexpr CurveGrid kPercentGrid{CurveAxis::kEntryToBeep, -10, 110, 481};

// Of n values (Welford 1962).
struct CurveStatistics {
    std::uint32_t n = 0;
    double mean = 0;
    double squares = 0;  // sum of squared deviations from the mean

    void add(double value);
    double sd() const;  // of the sample (n - 1); NaN below two values
};

// One trial on an axis; all that a mean trajectory needs of it.
struct TrialCurve {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

    TrialConditions conditions;
    bool placed = false;  // reached the event where the axis begins; without, nothing below
    bool beeped = false;
    double entry = kNone,
           beep =
               kNone;  // when, in the axis' unit: puncture of the tissue; beep, or the end of a trial without
    // At each grid point, to 0.001 % (a tenth of a pixel, a micrometre); NaN where the trial has no samples on
    // both sides of it.
    std::vector<double> needle_percent, surface_percent;
};
TrialCurve trial_curve(const TrialRecord& record, const CurveGrid& grid = kContactGrid);

// Needle and surface at each grid point, and the two events, over trials or over subjects.
struct CurveSums {
    std::vector<CurveStatistics> needle, surface;
    CurveStatistics entry, beep;
};

struct MeanCurve {
    CurveGrid grid;
    // Over subjects, whose trials are averaged first; of a single subject over trials. Per grid point over those that have samples there.
    CurveSums mean;
    // The needle of the first trial added: averaging trials of different phase hides an oscillation. NaN: no
    // sample.
    std::vector<double> example_needle_percent;
    std::uint32_t subjects = 0;
    std::uint32_t trials_with_beep = 0;
    std::uint32_t trials_without_beep = 0;
    std::uint32_t trials_left_out = 0;  // never reached the event where the axis begins

    std::uint32_t trials() const { return trials_with_beep + trials_without_beep; }
    std::uint32_t n() const { return subjects > 1 ? subjects : trials(); }
};

class MeanTrajectory {
  public:
    explicit MeanTrajectory(const CurveGrid& grid = kContactGrid);
    // On the same grid. The trials of one subject come one after the other.
    void add(const TrialCurve& trial);
    void add(const TrialRecord& record) { add(trial_curve(record, counts_.grid)); }
    MeanCurve curve() const;

  private:
    MeanCurve counts_;  // without its means
    std::uint32_t subject_ = 0;
    CurveSums of_subject_, of_earlier_;  // trials of the newest subject; means of those before
};

struct TrajectoryPanel {
    Modality modality = Modality::kHF;
    double delay_s = 0;
    MeanTrajectory mean;
};

// One mean trajectory per modality and delay, made when its first trial is added.
class TrajectoryPanels {
  public:
    explicit TrajectoryPanels(const CurveGrid& grid = kContactGrid) : grid_(grid) {}
    void add(const TrialCurve& trial);
    void add(const TrialRecord& record) { add(trial_curve(record, grid_)); }
    const std::vector<TrajectoryPanel>& panels() const { return panels_; }

  private:
    CurveGrid grid_;
    std::vector<TrajectoryPanel> panels_{};
};

// curves.csv: each trial of a study on the common axis of the trajectory figure. An interrupted study can draw earlier trials
// from it. A line per trial has its conditions, whether it has a place on the axis and beeped, puncture and beep
// on that axis. Needle and surface at each grid point follow, in percent of the fixture's depth (empty: no sample). The columns' names
// say which axis it is.
class CurveFile {
  public:
    // Throws Error as CsvFile.
    CurveFile(const std::filesystem::path& path, IfExists if_exists, const CurveGrid& grid = kContactGrid);
    // In the kernel's hands when it returns: a killed program loses nothing, a machine without power may.
    void append(const TrialCurve& trial);

  private:
    CsvFile file_;
    std::size_t points_;
};

using TakeCurve = std::function<void(const TrialCurve&)>;
// Hands over one curve after the other, in order: a curve is forty times a row, and no caller needs all at once.
// Throws Error (data) naming line and column of what cannot be read.
void read_curves(const std::filesystem::path& path, const TakeCurve& take, LastLine last = LastLine::kWhole,
                 const CurveGrid& grid = kContactGrid);

}  // namespace thimble
