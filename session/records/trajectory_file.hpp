// One trial's trajectory as CSV, a line per sample, closed by the comment "# ended: <outcome>". A file
// without that line was left behind by a program that died.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

// append() neither allocates nor waits for the disk, except for one write() when the buffer is full: call
// flush() from where a pause does no harm.
class TrajectoryWriter {
  public:
    explicit TrajectoryWriter(const std::filesystem::path& path, IfExists if_exists = IfExists::kRefuse);
    void append(const TrajectorySample& sample);
    void append(std::span<const TrajectorySample> samples);
    void flush();
    // The last line. Nothing may be appended after it.
    void end(EndReason reason, Role lost_peer = Role::kSession);

  private:
    CsvFile file_;
    std::vector<char> buffer_;
    std::size_t used_ = 0;
};

struct Trajectory {
    std::vector<TrajectorySample> samples;
    EndReason reason = EndReason::kNone;  // kNone: the file has no end
    Role lost_peer = Role::kSession;
};

// Throws Error (data) naming line and column of what cannot be read.
Trajectory read_trajectory(const std::filesystem::path& path);

}  // namespace thimble
