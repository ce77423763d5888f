// A trial that a run, a study (--trajectories) or free play has left in a folder, as far as a replay needs it.
#pragma once

#include <algorithm>
#include <filesystem>

#include "common/error.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_record.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

inline std::filesystem::path trajectory_of(const std::filesystem::path& folder,
                                           const TrialConditions& conditions) {
    auto file = find_trajectory(folder / "trajectories", conditions);
    if (!file.empty()) return file;
    throw Error(
        ExitCode::kUsage,
        "{}: the trajectory {} is missing: thimble study keeps trajectories with --trajectories, thimble "
        "play with --out",
        (folder / "trajectories").string(), trajectory_name(conditions));
}

struct RecordedTrial {
    TrialRecord record;  // samples, conditions, delay changes, how it ended; beep_time_s NaN without a beep
    std::filesystem::path file;

    double duration_s() const { return record.samples.back().time_s; }
    // The newest sample at `time_s`, which may lie before the first one.
    const TrajectorySample& at(double time_s) const {
        const auto after = std::upper_bound(
            record.samples.begin(), record.samples.end(), time_s,
            [](double time, const TrajectorySample& sample) { return time < sample.time_s; });
        return after == record.samples.begin() ? *after : *(after - 1);
    }

    // slave_sim's answer of that moment, as far as a trajectory keeps it: without velocity and stamps.
    ForceFeedback feedback(const TrajectorySample& sample) const {
        const double fixture_m = record.conditions.fixture_position_m;
        ForceFeedback f;
        copy_state(sample, f);
        f.position_proxy_m =
            sample.fixture_present ? std::min(sample.position_needle_m, fixture_m) : sample.position_needle_m;
        return f;
    }

    // One way, of the force path.
    double delay_s(double time_s) const {
        double delay_s = record.conditions.delay_s;
        for (const NetworkEvent& change : record.network_events) {
            if (change.time_s <= time_s) delay_s = change.delay_s;
        }
        return delay_s;
    }

    // The profile that held then; empty: the session file's own network.
    NetworkName network(double time_s) const {
        NetworkName name;
        for (const NetworkEvent& event : record.network_events) {
            if (event.time_s <= time_s && !event.profile.empty())
                name = NetworkName::of(event.profile).value_or(NetworkName{});
        }
        return name;
    }
};

// The `number`-th line of trials.csv in `folder`, from 1. `contact_hold_s` tells when the beep was: the table says only whether.
// Throws Error: usage, if there is no such trial, or its trajectory was not kept; data, if a file is damaged.
inline RecordedTrial find_recorded_trial(const std::filesystem::path& folder, std::size_t number,
                                         double contact_hold_s) {
    const auto rows = read_trial_table(folder / "trials.csv");
    if (number == 0 || number > rows.size()) {
        throw Error(ExitCode::kUsage, "{} has {} trials, but --trial is {}", (folder / "trials.csv").string(),
                    rows.size(), number);
    }
    const TrialRow& row = rows[number - 1];
    RecordedTrial trial;
    trial.file = trajectory_of(folder, row.conditions);
    trial.record.samples = read_trajectory(trial.file).samples;
    if (trial.record.samples.empty()) {
        throw Error(ExitCode::kData, "{}: has no samples to show", trial.file.string());
    }
    trial.record.conditions = row.conditions;
    trial.record.reason = row.reason;
    trial.record.lost_peer = row.lost_peer;
    std::error_code absent;
    if (std::filesystem::exists(event_path(trial.file), absent))
        trial.record.network_events = read_events(event_path(trial.file));
    const auto beep =
        std::find_if(trial.record.samples.begin(), trial.record.samples.end(),
                     [&](const TrajectorySample& s) { return s.contact_time_s >= contact_hold_s; });
    if (row.metrics.beeped && beep != trial.record.samples.end()) trial.record.beep_time_s = beep->time_s;
    return trial;
}

}  // namespace thimble
