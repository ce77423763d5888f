// One trial's trajectory as CSV, a line per sample, closed by the comment "# ended: <outcome>". A file
// without that line was left behind by a program that died.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
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
    fmt::memory_buffer buffer_;
};

struct Trajectory {
    std::vector<TrajectorySample> samples;
    EndReason reason = EndReason::kNone;  // kNone: the file has no end
    Role lost_peer = Role::kSession;
};

// "50ms": a delay as the names of all files have it.
std::string delay_in_names(double delay_s);
// "trial01_HF_50ms.csv", the name in the folder of a run.
std::string trajectory_name(const TrialConditions& conditions);
// The trajectory that a run or a study has kept in `folder`; empty: there is none.
std::filesystem::path find_trajectory(const std::filesystem::path& folder, const TrialConditions& conditions);
// Removes those that a run or a study has kept in `folder`, with their events: of trials that are to be replaced.
void remove_trajectories(const std::filesystem::path& folder);
// Throws Error (data) naming line and column of what cannot be read.
Trajectory read_trajectory(const std::filesystem::path& path, LastLine last = LastLine::kWhole);

// Changes during a trial that no sample holds: trajectories/<trial>.events.csv, beside the trajectory and only there if
// something did. Columns time_s, event, value. A delay is one line, a profile a group of seven lines of one time:
// profile (its name), delay_s, jitter_spread_s, loss of the force path, and the same of the needle's.

// trial01_HF_50ms.csv -> trial01_HF_50ms.events.csv
std::filesystem::path event_path(const std::filesystem::path& trajectory);
// Replaces an earlier file. Throws Error: usage, if it cannot be created; run failed, if the disk is full.
void write_events(const std::filesystem::path& path, const std::vector<NetworkEvent>& events);
// Throws Error (data) naming line and column of what cannot be read.
std::vector<NetworkEvent> read_events(const std::filesystem::path& path);

}  // namespace thimble
