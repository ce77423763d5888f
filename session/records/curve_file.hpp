// curves.csv: each trial of a study on the common axis of the trajectory figure, so that a study that was
// interrupted can draw what it ran before, and anybody can draw it otherwise. A line per trial: conditions,
// whether it entered the tissue and beeped, then needle and surface at each grid point in percent of the
// fixture's depth (empty: no sample).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "session/records/mean_trajectory.hpp"

namespace thimble {

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
