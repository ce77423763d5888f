// The files that an interrupted study left in its folder, and the tables with which it goes on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "session/records/mean_trajectory.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

// One table of trials with its curves: NAME.csv and NAME_curves.csv.
class StudyTables {
  public:
    // IfExists::kContinue reads the earlier trials, passes the curve of each to `take_curve`, and cuts off half-written lines.
    // Throws Error before it changes a byte: usage, if the trials are not the first of `planned` (another study, seed or
    // version) or the curves have another axis; data, if a table is damaged or has no curves.
    StudyTables(const std::filesystem::path& folder, const std::string& name, IfExists if_exists,
                const std::vector<TrialConditions>& planned, const TakeCurve& take_curve,
                const CurveGrid& grid = kContactGrid);

    // The trials that need not be run again, in order.
    const std::vector<TrialRow>& rows() const { return earlier_; }

    // The row is on the disk when it returns, its curve before it.
    void append(const TrialRow& row, const TrialCurve& curve);

  private:
    std::vector<TrialRow> earlier_;
    TrialTable table_;
    CurveFile curves_;
};

// All that an earlier study or run has left beside trials.csv and would pass for the new one's: side tables, trajectories, figures, report.
// The caller makes sure that no program writes trials.csv. Throws Error (usage) if a file cannot be removed.
void remove_earlier_results(const std::filesystem::path& folder);

}  // namespace thimble
