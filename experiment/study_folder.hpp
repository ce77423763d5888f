// What a study that was interrupted left in its folder, and the tables it goes on with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/curve_file.hpp"
#include "experiment/trial_table.hpp"

namespace thimble {

// One table of trials with its curves: NAME.csv and NAME_curves.csv.
class StudyTables {
  public:
    // With IfExists::kContinue the trials that are there are read; half-written lines are cut off. Throws
    // Error: usage, if they are not the first of `planned` (another study, seed or version); data, if a table
    // is damaged.
    StudyTables(const std::filesystem::path& folder, const std::string& name, IfExists if_exists,
                const std::vector<TrialConditions>& planned);

    // The trials that need not be run again, in order.
    const std::vector<TrialRow>& rows() const { return earlier_.rows; }
    const std::vector<TrialCurve>& curves() const { return earlier_.curves; }

    // The row is on the disk when it returns, its curve before it.
    void append(const TrialRow& row, const TrialCurve& curve);

  private:
    struct Earlier {
        std::vector<TrialRow> rows;
        std::vector<TrialCurve> curves;
    };
    static Earlier recover(const std::filesystem::path& table, const std::filesystem::path& curves);

    Earlier earlier_;
    TrialTable table_;
    CurveFile curves_;
};

}  // namespace thimble
