// Recorded movements as a dataset in the layout of Motion-BIDS (Brain Imaging Data Structure 1.9, "Motion"), made new from what a
// participant session, or `thimble study --trajectories`, has written. For each trial with a trajectory that has samples:
//
//     sub-07/motion/sub-07_task-needle_tracksys-slave_run-01_motion.tsv      a line per sample, without a header
//                   ..._motion.json, ..._channels.tsv                        what its columns are
//                   ..._events.tsv, ..._events.json                          the trial's conditions, puncture, contact with the fixture, beep
//
// run: the record of a participant session; of a study, or of `thimble run`, the trial's place, with the experiment in the task
// (task-needleExperiment3).
#pragma once

#include <filesystem>

namespace thimble {

struct MotionExport {
    std::size_t subjects = 0, trials = 0;
    std::size_t without_trajectory = 0;  // of the trials in the tables
};

// `to` must be new or empty. Throws Error: usage, if it is not, or `from` is neither dataset nor study; data, if a file cannot be read, or
// there is no trajectory at all; run failed, if something cannot be written.
MotionExport export_motion(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace thimble
