// Finding a trial in a folder, and what was seen when.
#include "session/play/recorded_trial.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TrialRecord short_record() {
    TrialRecord record;
    record.conditions.trial = 2;
    record.conditions.modality = Modality::kVF;
    record.conditions.delay_s = 0.05;
    record.conditions.fixture_position_m = 0.02;
    record.reason = EndReason::kCompleted;
    for (int i = 0; i < 1000; ++i) {
        TrajectorySample sample;
        sample.time_s = 0.001 * i;
        sample.position_needle_m = 0.00005 * i;
        sample.contact_time_s = i > 500 ? 0.001 * (i - 500) : 0;
        record.samples.push_back(sample);
    }
    record.beep_time_s = 0.7;
    return record;
}

void keep(const TrialRecord& record, const std::filesystem::path& folder, const std::string& name) {
    TrialTable table(folder / "trials.csv", IfExists::kReplace);
    table.append(make_row(record));
    std::filesystem::create_directories(folder / "trajectories");
    TrajectoryWriter writer(folder / "trajectories" / name);
    writer.append(record.samples);
    writer.end(record.reason);
}

TEST(RecordedTrial, IsFoundByTheNamesOfRunsAndOfStudies) {
    for (const char* name : {"trial02_VF_50ms.csv", "experiment3_subject01_trial02_VF_50ms.csv"}) {
        const TemporaryDirectory directory;
        keep(short_record(), directory.path(), name);
        const RecordedTrial trial = find_recorded_trial(directory.path(), 1, 0.2);
        EXPECT_EQ(trial.record.samples.size(), 1000U);
        EXPECT_EQ(trial.record.conditions.modality, Modality::kVF);
        EXPECT_EQ(trial.record.conditions.fixture_position_m, 0.02);
        EXPECT_NEAR(trial.record.beep_time_s, 0.7, 1e-9);
        EXPECT_EQ(trial.duration_s(), 0.999);
    }
}

TEST(RecordedTrial, KnowsWhatWasThereWhenAndHowLate) {
    const TemporaryDirectory directory;
    keep(short_record(), directory.path(), "trial02_VF_50ms.csv");
    write_events(directory / "trajectories/trial02_VF_50ms.events.csv", {{0.3, 0.5}, {0.6, 0}});
    const RecordedTrial trial = find_recorded_trial(directory.path(), 1, 0.2);
    EXPECT_EQ(trial.delay_s(0.1), 0.05);
    EXPECT_EQ(trial.delay_s(0.3), 0.5);
    EXPECT_EQ(trial.delay_s(0.9), 0);
    EXPECT_EQ(trial.at(0.4005).time_s, 0.4);
    EXPECT_EQ(trial.at(-1).time_s, 0);
    EXPECT_EQ(trial.at(5).time_s, 0.999);
}

TEST(RecordedTrial, SaysWhatIsMissing) {
    const TemporaryDirectory directory;
    EXPECT_THROW(find_recorded_trial(directory.path(), 1, 5), Error);
    keep(short_record(), directory.path(), "trial02_VF_50ms.csv");
    EXPECT_THROW(find_recorded_trial(directory.path(), 0, 5), Error);
    EXPECT_THROW(find_recorded_trial(directory.path(), 2, 5), Error);
    std::filesystem::remove(directory / "trajectories/trial02_VF_50ms.csv");
    EXPECT_THAT(refusal([&] { find_recorded_trial(directory.path(), 1, 5); }, ExitCode::kUsage),
                testing::HasSubstr("--trajectories"));
}

}  // namespace
}  // namespace thimble
