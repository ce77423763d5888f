// Movements for others, in the layout of Motion-BIDS, judged by BIDS' own validator.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "session/participant/dataset.hpp"
#include "session/participant/record_table.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/full_disk.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/participant/bids_validator.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A study of two subjects with a trial each; the second trial has no trajectory.
class MotionBids : public testing::Test {
  protected:
    MotionBids() {
        std::filesystem::create_directories(study() / "trajectories");
        TrialTable table(study() / "trials.csv");
        for (const std::uint32_t subject : {1U, 2U}) {
            TrialRow row;
            row.conditions.subject = subject;
            row.conditions.modality = Modality::kCF;
            row.conditions.delay_s = 0.05;
            row.reason = EndReason::kCompleted;
            row.metrics.puncture_time_s = 0.002;
            row.metrics.completion_time_s = 0.005;
            row.metrics.beeped = true;
            table.append(row);
        }
        std::vector<double> times_s;
        for (int i = 0; i < 10; ++i) times_s.push_back(0.001 * i);
        write_trajectory(times_s);
    }
    void write_trajectory(const std::vector<double>& times_s) const {
        TrajectoryWriter writer(study() / "trajectories" / "experiment3_subject01_trial01_CF_50ms.csv",
                                IfExists::kReplace);
        for (const double time_s : times_s) writer.append({time_s, 10 * time_s, 0.02, -0.25, -0.5, -0.75, 0});
        writer.end(EndReason::kCompleted);
    }
    std::filesystem::path study() const { return folder_ / "study"; }
    std::filesystem::path bids() const { return folder_ / "bids"; }
    std::string written(const std::string& ending) const {
        return read_text(bids() / "sub-01" / "motion" /
                         ("sub-01_task-needleExperiment3_tracksys-slave_run-01_" + ending));
    }

    // Their file of a run, or of `thimble play`.
    void rename_as_of_a_run() const {
        std::filesystem::rename(study() / "trajectories" / "experiment3_subject01_trial01_CF_50ms.csv",
                                study() / "trajectories" / "trial01_CF_50ms.csv");
    }
    // Of the export: description, page and table of subjects in one text.
    std::string subjects_words() const {
        std::filesystem::remove_all(bids());
        export_motion(study(), bids());
        std::string words;
        for (const char* name : {"dataset_description.json", "README.md", "participants.tsv"})
            words += read_text(bids() / name);
        return words;
    }

    const TemporaryDirectory folder_;
};

TEST_F(MotionBids, OnlyWhatIsKnownToBeVirtualIsCalledVirtual) {
    const auto is_virtual = AllOf(HasSubstr(R"("SubjectKind": "virtual")"), HasSubstr("No person took part"),
                                  HasSubstr("sub-01\tn/a\tvirtual\n"));
    EXPECT_THAT(subjects_words(), is_virtual) << "a study, also one that was killed";
    rename_as_of_a_run();
    for (const char* summary : {"", "[1]", R"({"provenance": {"seed": "1"}})"}) {
        if (*summary != '\0') write_text(study() / "summary.json", summary);
        EXPECT_THAT(subjects_words(), AllOf(HasSubstr("sub-01\tn/a\tn/a\n"), Not(HasSubstr("irtual")),
                                            Not(HasSubstr("No person")), Not(HasSubstr("SubjectKind"))))
            << summary;
    }
    write_text(study() / "summary.json", R"({"provenance": {"kind of subjects": "virtual"}})");
    EXPECT_THAT(subjects_words(), is_virtual) << "a run";
}

TEST_F(MotionBids, HoldsTheSamplesWithTheirUnits) {
    const MotionExport done = export_motion(study(), bids());
    EXPECT_EQ(done.subjects, 1U);
    EXPECT_EQ(done.trials, 1U);
    EXPECT_EQ(done.without_trajectory, 1U);
    EXPECT_THAT(written("motion.tsv"), testing::StartsWith("0\t0\t0.02\t-0.25\t-0.5\t-0.75\n0.001\t0.01\t"));
    EXPECT_THAT(written("channels.tsv"), HasSubstr("force_total\tz\tMISC\tneedle\tN\t"));
    EXPECT_THAT(written("events.tsv"), HasSubstr("0\t0\ttrial_start\tCF\t0.05\t"));
    EXPECT_THAT(written("events.tsv"), HasSubstr("0.007\t0\tbeep\t"));
    EXPECT_EQ(nlohmann::json::parse(written("motion.json"))["MotionChannelCount"], 6);
    EXPECT_THROW(export_motion(study(), bids()), Error);  // never into what is there
}

TEST_F(MotionBids, TheSamplingFrequencyIsThatOfTheTrial) {
    for (const double period_s : {1e-3, 1e-4, 2.5e-4}) {
        std::filesystem::remove_all(bids());
        std::vector<double> times_s;
        for (int i = 0; i < 100; ++i) {
            if (i % 20 == 7) continue;                                 // lost
            times_s.push_back(period_s * i + 1e-7 * (i * 7 % 5 - 2));  // a wake-up that is late or early
        }
        write_trajectory(times_s);
        export_motion(study(), bids());
        const auto motion = nlohmann::json::parse(written("motion.json"));
        EXPECT_EQ(motion["SamplingFrequency"], std::lround(1 / period_s));
        EXPECT_NEAR(motion["SamplingFrequencyEffective"].get<double>(), 1 / period_s, 0.2 / period_s);
    }
}

// A program that is killed leaves part of a line. The trial keeps its whole lines, and the others are exported.
TEST_F(MotionBids, ATornTrajectoryKeepsItsWholeLines) {
    const auto torn = study() / "trajectories" / "experiment3_subject02_trial01_CF_50ms.csv";
    const std::string whole =
        read_text(study() / "trajectories" / "experiment3_subject01_trial01_CF_50ms.csv");
    write_text(torn, whole.substr(0, whole.find("\n0.005") + 4));
    EXPECT_EQ(export_motion(study(), bids()).trials, 2U);
    const std::string text = read_text(bids() / "sub-02" / "motion" /
                                       "sub-02_task-needleExperiment3_tracksys-slave_run-01_motion.tsv");
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
}

TEST_F(MotionBids, WhatHoldsNothingIsRefused) {
    write_trajectory({0.5});
    EXPECT_THROW(export_motion(study(), bids()), Error);
    std::filesystem::remove_all(study() / "trajectories");
    EXPECT_THROW(export_motion(study(), bids()), Error);
    EXPECT_THROW(export_motion(folder_ / "none", bids()), Error);
}

TEST_F(MotionBids, OrdersAnswersExclusionsAndCorrectionsOfParticipantsComeAlong) {
    const Dataset dataset(folder_ / "people");
    dataset.open(SubjectKind::kVirtual, {});
    add_participant(dataset, 1, SubjectKind::kVirtual, {});
    DatasetRecord record;
    record.row = read_trial_table(study() / "trials.csv").front();
    RecordTable(dataset.records(1)).append(record);
    for (const char* part : {"orders", "phenotype"})
        std::filesystem::create_directory(dataset.folder() / part);
    const auto samples = dataset.source(1) / "trajectories";
    std::filesystem::create_directories(samples);
    std::filesystem::copy_file(study() / "trajectories" / "experiment3_subject01_trial01_CF_50ms.csv",
                               samples / "record001_experiment3_trial01_CF_50ms.csv");
    const auto names = {"orders/sub-01_order.tsv", "exclusions.tsv",        "attention.tsv",
                        "corrections.tsv",         "phenotype/ratings.tsv", "phenotype/ratings.json"};
    for (const char* name : names) write_text(dataset.folder() / name, "lines\n");
    write_text(dataset.folder() / "phenotype/load.tsv.new", "half");  // of a crash
    EXPECT_EQ(export_motion(dataset.folder(), bids()).trials, 1U);
    for (const char* name : names) EXPECT_EQ(read_text(bids() / name), "lines\n") << name;
    EXPECT_FALSE(std::filesystem::exists(bids() / "phenotype/load.tsv.new"));
    EXPECT_EQ(read_text(bids() / ".bidsignore"), read_text(dataset.folder() / ".bidsignore"));
}

TEST_F(MotionBids, AFullDiskUnderACopyIsAFailureOfTheRun) {
    const Dataset dataset(folder_ / "people");
    dataset.open(SubjectKind::kVirtual, {});
    EXPECT_THAT(refusal([&] { export_motion(dataset.folder(), bids()); }),
                AllOf(HasSubstr("run a trial of a participant"), Not(HasSubstr("thimble study"))));
    write_text(dataset.folder() / "README.md", std::string(200'000, 'x'));
    const FullDisk disk(100'000);
    EXPECT_THAT(refusal([&] { export_motion(dataset.folder(), bids()); }, ExitCode::kRunFailed),
                HasSubstr("README.md"));
}

// The folder is as empty as it was, so that the same command works once there is something.
TEST_F(MotionBids, WhatFailsLeavesNothingBehind) {
    const auto kept = study() / "trajectories", away = folder_ / "away";
    std::filesystem::rename(kept, away);
    EXPECT_THROW(export_motion(study(), bids()), Error);
    std::filesystem::rename(away, kept);
    EXPECT_EQ(export_motion(study(), bids()).trials, 1U);
}

TEST_F(MotionBids, TheirValidatorFindsNoError) {
    if (bids_validator().empty())
        GTEST_SKIP() << "bids-validator is not installed: deploy/install-validators does that where "
                        "there is npm (package npm)";
    export_motion(study(), bids());
    const auto said = folder_ / "said";
    const auto found = judged_by_bids(bids(), said);
    ASSERT_TRUE(found.is_object()) << read_text(said.string() + ".err");
    EXPECT_EQ(found["issues"]["errors"], nlohmann::json::array());
    EXPECT_THAT(found["summary"]["dataTypes"].dump(), HasSubstr("motion"));
}

}  // namespace
}  // namespace thimble
