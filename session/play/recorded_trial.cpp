#include "session/play/recorded_trial.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {
namespace {

std::filesystem::path trajectory_of(const std::filesystem::path& folder, const TrialConditions& conditions) {
    auto file = find_trajectory(folder / "trajectories", conditions);
    if (!file.empty()) return file;
    throw Error(ExitCode::kUsage,

                "{}: the trajectory {} was not kept: thimble study keeps them with --trajectories, thimble "
                "play with --record",
                (folder / "trajectories").string(), trajectory_name(conditions));
}

}  // namespace

const TrajectorySample& RecordedTrial::at(double time_s) const {
    const auto after =
        std::upper_bound(record.samples.begin(), record.samples.end(), time_s,
                         [](double time, const TrajectorySample& sample) { return time < sample.time_s; });
    return after == record.samples.begin() ? *after : *(after - 1);
}

ForceFeedback RecordedTrial::feedback(const TrajectorySample& sample) const {
    const double fixture_m = record.conditions.fixture_position_m;
    ForceFeedback f;
    copy_state(sample, f);
    f.position_proxy_m =
        sample.fixture_present ? std::min(sample.position_needle_m, fixture_m) : sample.position_needle_m;
    return f;
}

double RecordedTrial::delay_s(double time_s) const {
    double delay_s = record.conditions.delay_s;
    for (const NetworkEvent& change : record.network_events) {
        if (change.time_s <= time_s) delay_s = change.delay_s;
    }
    return delay_s;
}

NetworkName RecordedTrial::network(double time_s) const {
    NetworkName name;
    for (const NetworkEvent& event : record.network_events) {
        if (event.time_s <= time_s && !event.profile.empty())
            name = NetworkName::of(event.profile).value_or(NetworkName{});
    }
    return name;
}

RecordedTrial find_recorded_trial(const std::filesystem::path& folder, std::size_t number,
                                  double contact_hold_s) {
    const auto rows = read_trial_table(folder / "trials.csv");
    if (number == 0 || number > rows.size()) {
        throw Error(ExitCode::kUsage, "{} has {} trials, and --trial says {}",
                    (folder / "trials.csv").string(), rows.size(), number);
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
