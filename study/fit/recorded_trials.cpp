#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "master/operator/operator_parameters.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "study/fit/operator_model.hpp"

namespace thimble {
namespace {

// The paper's experiments 1 and 3 have other people: their subjects 1 are two persons.
void require_one_person(const std::filesystem::path& table, const std::vector<TrialRow>& rows) {
    std::set<std::uint32_t> experiments, cohorts;
    for (const TrialRow& row : rows) {
        experiments.insert(row.conditions.experiment);
        cohorts.insert(cohort_of(row.conditions.experiment));
    }
    if (cohorts.size() < 2) return;
    throw Error(ExitCode::kData,
                "{}: subject {} of experiments {} need not be the same person: choose one experiment with "
                "--experiment {}",
                table.string(), rows.front().conditions.subject, fmt::join(experiments, " and "),
                fmt::join(experiments, " or "));
}

void require_table(const std::filesystem::path& table) {
    if (std::filesystem::exists(table)) return;
    const auto folder = table.parent_path();
    if (std::filesystem::exists(folder / "participants.tsv"))
        throw Error(ExitCode::kData,
                    "{}: is a dataset of participants, which thimble fit cannot read: name a folder of "
                    "thimble study, or of thimble run without [protocol]",
                    folder.string());
    throw Error(ExitCode::kData,
                "{}: does not exist: name a folder that thimble study or thimble run has written",
                table.string());
}

std::vector<TrialRow> rows_of_subject(const std::filesystem::path& table, std::uint32_t subject,
                                      std::optional<std::uint32_t> experiment) {
    require_table(table);
    std::vector<TrialRow> own;
    std::set<std::uint32_t> subjects;
    for (const TrialRow& row : without_removals(read_trial_table(table))) {
        if (experiment && row.conditions.experiment != *experiment) continue;
        subjects.insert(row.conditions.subject);
        if (row.conditions.subject == subject) own.push_back(row);
    }
    if (own.empty())
        throw Error(ExitCode::kData, "{}: has no trial of subject {}{}; it has trials of {}", table.string(),
                    subject, experiment ? fmt::format(" in experiment {}", *experiment) : "",
                    subjects.empty() ? "no subject" : fmt::format("{}", fmt::join(subjects, ", ")));
    require_one_person(table, own);
    return own;
}

std::filesystem::path trajectory_of(const std::filesystem::path& folder, const TrialConditions& conditions) {
    std::filesystem::path file = find_trajectory(folder / "trajectories", conditions);
    if (!file.empty()) return file;
    throw Error(ExitCode::kData,
                "{}: has no {}: repeat the study with --trajectories, or copy the whole folder",
                (folder / "trajectories").string(), trajectory_name(conditions));
}

void require_two_of_each(const RecordedTrials& recorded, std::uint32_t subject) {
    std::vector<TrialConditions> conditions;
    conditions.reserve(recorded.trials.size());
    for (const ObservedTrial& trial : recorded.trials) conditions.push_back(trial.conditions);
    if (conditions.empty())
        throw Error(ExitCode::kData,
                    "subject {}: no trial reached the beep, so there is nothing to fit: record trials with "
                    "less delay",
                    subject);
    for (const FitGroup& group : fit_groups(conditions)) {
        if (group.trials.size() > 1) continue;
        throw Error(ExitCode::kData,
                    "subject {}: has one usable trial with {} at {}, but a fit needs two: record more trials",
                    subject, to_string(group.modality), delay_text(group.delay_s));
    }
}

}  // namespace

RecordedTrials recorded_trials(const std::filesystem::path& folder, std::uint32_t subject,
                               std::optional<std::uint32_t> experiment) {
    RecordedTrials recorded;
    for (const TrialRow& row : rows_of_subject(folder / "trials.csv", subject, experiment)) {
        const double beep_s = row.metrics.puncture_time_s + row.metrics.completion_time_s;
        std::optional<TrialFeatures> features;
        if (row.metrics.beeped && ran_to_its_end(row)) {
            const Trajectory trajectory = read_trajectory(trajectory_of(folder, row.conditions));
            features = trial_features(trajectory.samples, row.conditions.fixture_position_m, beep_s);
        }
        if (features)
            recorded.trials.push_back({row.conditions, *features});
        else
            ++recorded.left_out;
    }
    require_two_of_each(recorded, subject);
    return recorded;
}

}  // namespace thimble
