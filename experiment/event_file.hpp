// What happened to a trial that no sample says: trajectories/<trial>.events.csv, beside the trajectory and only there if
// something did. Columns time_s, event, value; today one event, delay_s: the force path's one-way delay from then on.
#pragma once

#include <filesystem>
#include <vector>

#include "experiment/trial_record.hpp"

namespace thimble {

// trial01_HF_50ms.csv -> trial01_HF_50ms.events.csv
std::filesystem::path event_path(const std::filesystem::path& trajectory);
// Replaces an earlier file. Throws Error: usage, if it cannot be created; run failed, if the disk is full.
void write_events(const std::filesystem::path& path, const std::vector<DelayChange>& changes);
// Throws Error (data) naming line and column of what cannot be read.
std::vector<DelayChange> read_events(const std::filesystem::path& path);

}  // namespace thimble
