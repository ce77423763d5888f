// Mean and standard deviation over trials of needle and tissue surface on a common axis: time from the first
// puncture of the tissue (0 %) to the beep (100 %), depth in percent of the trial's own fixture depth. Trials
// are added one by one and not kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

inline constexpr double kCurveBegin_percent = -10;
inline constexpr double kCurveEnd_percent = 110;

// Per grid point, over the trials that have samples on both sides of it: a trial may begin later than -10 %
// and end before 110 %.
struct CurveStatistics {
    std::uint32_t trials = 0;
    double mean_percent = 0;
    double squares_percent2 = 0;  // sum of squared deviations from the mean (Welford 1962)

    void add(double value_percent);
    double sd_percent() const;  // of the sample (n - 1); NaN below two trials
};

struct MeanCurve {
    std::vector<double> time_percent;  // of each grid point
    std::vector<CurveStatistics> needle;
    std::vector<CurveStatistics> surface;
    // The needle of the first trial added: averaging trials of different phase hides an oscillation. NaN: no
    // sample.
    std::vector<double> example_needle_percent;
    std::uint32_t trials_with_beep = 0;
    std::uint32_t trials_without_beep = 0;   // their end counts as 100 %
    std::uint32_t trials_without_entry = 0;  // never punctured the tissue: no common axis, left out
    std::uint32_t trials() const { return trials_with_beep + trials_without_beep; }
};

inline constexpr std::size_t kCurvePoints = 481;  // a step of 0.25 %

// From kCurveBegin_percent to kCurveEnd_percent. points >= 2 (asserted).
std::vector<double> curve_grid_percent(std::size_t points = kCurvePoints);

// One trial on that axis; all that a mean trajectory needs of it.
struct TrialCurve {
    TrialConditions conditions;
    bool entered = false;  // punctured the tissue; without, there is no axis, and nothing below
    bool beeped = false;
    // At each grid point, to 0.001 % (a tenth of a pixel, a micrometre); NaN where the trial has no samples on
    // both sides of it.
    std::vector<double> needle_percent, surface_percent;
};
TrialCurve trial_curve(const TrialRecord& record, std::size_t points = kCurvePoints);

class MeanTrajectory {
  public:
    explicit MeanTrajectory(std::size_t points = kCurvePoints);
    void add(const TrialCurve& trial);  // on the same grid
    void add(const TrialRecord& record) { add(trial_curve(record, curve_.time_percent.size())); }
    const MeanCurve& curve() const { return curve_; }

  private:
    MeanCurve curve_;
};

struct TrajectoryPanel {
    Modality modality = Modality::kHF;
    double delay_s = 0;
    MeanTrajectory mean;
};

// One mean trajectory per modality and delay, made when its first trial is added.
class TrajectoryPanels {
  public:
    void add(const TrialCurve& trial);
    void add(const TrialRecord& record) { add(trial_curve(record)); }
    const std::vector<TrajectoryPanel>& panels() const { return panels_; }

  private:
    std::vector<TrajectoryPanel> panels_;
};

// curves.csv: each trial of a study on the common axis of the trajectory figure. An interrupted study can draw earlier trials
// from it. A line per trial: conditions, whether it entered the tissue and beeped, then needle and surface at each grid point
// in percent of the fixture's depth (empty: no sample).
class CurveFile {
  public:
    // Throws Error as CsvFile.
    CurveFile(const std::filesystem::path& path, IfExists if_exists);
    // In the kernel's hands when it returns: a killed program loses nothing, a machine without power may.
    void append(const TrialCurve& trial);

  private:
    CsvFile file_;
};

using TakeCurve = std::function<void(const TrialCurve&)>;
// Hands over one curve after the other, in order: a curve is forty times a row, and no caller needs all at once.
// Throws Error (data) naming line and column of what cannot be read.
void read_curves(const std::filesystem::path& path, const TakeCurve& take, LastLine last = LastLine::kWhole);

}  // namespace thimble
