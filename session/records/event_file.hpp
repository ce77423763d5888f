// What happened to a trial that no sample says: trajectories/<trial>.events.csv, beside the trajectory and only there if
// something did. Columns time_s, event, value; docs/play.md lists the events. A profile is a group of seven lines of one time:
// profile (its name), delay_s, jitter_spread_s, loss of the force path, and the same of the needle's.
#pragma once

#include <filesystem>
#include <vector>

#include "session/records/trial_record.hpp"

namespace thimble {

// trial01_HF_50ms.csv -> trial01_HF_50ms.events.csv
std::filesystem::path event_path(const std::filesystem::path& trajectory);
// Replaces an earlier file. Throws Error: usage, if it cannot be created; run failed, if the disk is full.
void write_events(const std::filesystem::path& path, const std::vector<NetworkEvent>& events);
// Throws Error (data) naming line and column of what cannot be read.
std::vector<NetworkEvent> read_events(const std::filesystem::path& path);

}  // namespace thimble
