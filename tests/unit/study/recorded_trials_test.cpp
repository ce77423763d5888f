// A fit is of one person, and of one whom its traits can describe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/fit/fit.hpp"
#include "study/fit/operator_model.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;

void write_rows(const std::filesystem::path& folder, std::initializer_list<std::uint32_t> experiments) {
    TrialTable table(folder / "trials.csv", IfExists::kReplace);
    for (const std::uint32_t experiment : experiments) {
        TrialRow row;
        row.conditions.experiment = experiment;
        row.conditions.subject = 4;
        row.conditions.trial = 1;
        row.conditions.removes_fixture = experiment == 2;
        row.conditions.delay_s = experiment == 3 ? 0.05 : 0;
        row.reason = EndReason::kCompleted;
        row.metrics.beeped = true;
        table.append(row);
    }
}

TEST(RecordedTrials, OneNumberOfTwoCohortsIsNotOnePerson) {
    const TemporaryDirectory folder;
    write_rows(folder.path(), {1, 2, 3});
    EXPECT_THAT(refusal([&] { recorded_trials(folder.path(), 4); }),
                AllOf(HasSubstr("trials.csv"), HasSubstr("subject 4 of experiments 1 and 3"),
                      HasSubstr("--experiment 1 or 3")));
}

// One experiment's trials go on to their trajectories.
TEST(RecordedTrials, AnExperimentCanBeChosen) {
    const TemporaryDirectory folder;
    write_rows(folder.path(), {1, 2, 3});
    EXPECT_THAT(refusal([&] { recorded_trials(folder.path(), 4, 3); }), HasSubstr("--trajectories"));
    EXPECT_THAT(refusal([&] { recorded_trials(folder.path(), 5, 3); }),
                HasSubstr("no trial of subject 5 in experiment 3; it has trials of 4"));
    write_rows(folder.path(), {1, 2});
    EXPECT_THAT(refusal([&] { recorded_trials(folder.path(), 4); }), HasSubstr("--trajectories"));
    EXPECT_THAT(refusal([&] { recorded_trials(folder.path(), 4, 3); }), HasSubstr("trials of no subject"));
}

TEST(RecordedTrials, ADatasetOfParticipantsIsNamed) {
    const TemporaryDirectory folder;
    write_text(folder / "participants.tsv", "participant_id\n");
    EXPECT_THAT(refusal([&] { recorded_trials(folder.path(), 4); }),
                HasSubstr("is a dataset of participants, which thimble fit cannot read"));
}

TEST(Fit, RefusesKeysThatNoTraitStandsFor) {
    const TemporaryDirectory folder;
    const auto words = [&](const char* key) {
        const SystemSettings settings = load_system_settings({}, {{key, 0.5}});
        FitOptions options;
        options.folder = folder.path();
        options.out = folder / "fit";
        return refusal([&] { run_fit(settings, options); }, ExitCode::kUsage);
    };
    EXPECT_THAT(words("operator.press_N"), AllOf(HasSubstr("press_N is 0.5"), HasSubstr("--session")));
    EXPECT_THAT(words("operator.spread_experience"), HasSubstr("spread_experience is 0.5"));
}

}  // namespace
}  // namespace thimble
