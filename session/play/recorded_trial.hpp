// A trial that a run, a study (--trajectories) or free play has left in a folder, as far as a replay needs it.
#pragma once

#include <filesystem>

#include "session/records/trial_record.hpp"

namespace thimble {

struct RecordedTrial {
    TrialRecord record;  // samples, conditions, delay changes, how it ended; beep_time_s NaN without a beep
    std::filesystem::path file;

    double duration_s() const { return record.samples.back().time_s; }
    // The newest sample at `time_s`, which may lie before the first one.
    const TrajectorySample& at(double time_s) const;
    // slave_sim's answer of that moment, as far as a trajectory keeps it: without velocity and stamps.
    ForceFeedback feedback(const TrajectorySample& sample) const;
    // One way, of the force path.
    double delay_s(double time_s) const;
    // The profile that held then; empty: the session file's own network.
    NetworkName network(double time_s) const;
};

// The `number`-th line of trials.csv in `folder`, from 1. `contact_hold_s` tells when the beep was: the table says only whether.
// Throws Error: usage, if there is no such trial, or its trajectory was not kept; data, if a file is damaged.
RecordedTrial find_recorded_trial(const std::filesystem::path& folder, std::size_t number,
                                  double contact_hold_s);

}  // namespace thimble
