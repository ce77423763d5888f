#include "session/records/mean_trajectory.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TEST(MeanTrajectory, IdenticalTrialsHaveNoSpread) {
    MeanTrajectory mean;
    const TrialRecord record = sine_record(0.004, 0.003, 1.3);
    for (int i = 0; i < 7; ++i) mean.add(record);
    const MeanCurve& curve = mean.curve();
    ASSERT_EQ(curve.time_percent.size(), 481U);
    EXPECT_DOUBLE_EQ(curve.time_percent.front(), -10);
    EXPECT_DOUBLE_EQ(curve.time_percent.back(), 110);
    for (std::size_t i = 0; i < curve.needle.size(); ++i) {
        ASSERT_EQ(curve.needle[i].trials, 7U);
        ASSERT_EQ(curve.needle[i].sd_percent(), 0);
        ASSERT_EQ(curve.surface[i].sd_percent(), 0);
        ASSERT_EQ(curve.needle[i].mean_percent, curve.example_needle_percent[i]);
    }
    EXPECT_EQ(curve.trials_with_beep, 7U);
}

// Needle as deep as time has passed: on the common axis a straight line, whatever the trial's length and
// depth.
TrialRecord ramp(double entry_s, double beep_s, double fixture_m, double end_s, int step_ms) {
    TrialRecord record;
    record.conditions.fixture_position_m = fixture_m;
    record.beep_time_s = beep_s;
    for (int i = 0; i <= static_cast<int>(end_s * 1000); i += step_ms) {
        TrajectorySample sample;
        sample.time_s = i / 1000.0;
        sample.position_needle_m = fixture_m * (sample.time_s - entry_s) / (beep_s - entry_s);
        sample.position_surface_m = 0.16 * fixture_m;
        sample.phase = sample.time_s >= entry_s ? TissuePhase::kPenetrated : TissuePhase::kFree;
        record.samples.push_back(sample);
    }
    return record;
}

TEST(MeanTrajectory, TimeAndDepthAreNormalisedPerTrial) {
    MeanTrajectory mean(13);
    mean.add(ramp(2, 10, 0.11, 12, 1));
    mean.add(ramp(1, 6, 0.13, 8, 10));
    for (std::size_t i = 0; i < 13; ++i) {
        EXPECT_NEAR(mean.curve().time_percent[i], -10 + 10.0 * static_cast<double>(i), 1e-9);
        EXPECT_NEAR(mean.curve().needle[i].mean_percent, mean.curve().time_percent[i], 1e-9);
        EXPECT_NEAR(mean.curve().needle[i].sd_percent(), 0, 1e-9);
        EXPECT_NEAR(mean.curve().surface[i].mean_percent, 16, 1e-9);
    }
}

TEST(MeanTrajectory, MeanAndStandardDeviationOfDifferentTrials) {
    MeanTrajectory mean(3);  // -10, 50, 110 %
    for (const double penetration_m : {0.001, 0.002, 0.006}) {
        mean.add(make_record([=](double) { return penetration_m; }));
    }
    // At 50 %: 100 % + {0.8, 1.6, 4.8} %, so mean 102.4 and SD sqrt((1.6^2 + 0.8^2 + 2.4^2) / 2).
    EXPECT_NEAR(mean.curve().needle[1].mean_percent, 102.4, 1e-9);
    EXPECT_NEAR(mean.curve().needle[1].sd_percent(), std::sqrt((2.56 + 0.64 + 5.76) / 2), 1e-9);
}

TEST(MeanTrajectory, TrialsWithoutBeepOrEntryAreCountedApart) {
    MeanTrajectory mean(13);
    TrialRecord timeout = ramp(2, 10, 0.12, 10, 1);
    timeout.beep_time_s = kNaN;
    mean.add(timeout);
    TrialRecord never_entered = ramp(2, 10, 0.12, 10, 1);
    for (TrajectorySample& sample : never_entered.samples) sample.phase = TissuePhase::kFree;
    mean.add(never_entered);
    mean.add(TrialRecord{});
    EXPECT_EQ(mean.curve().trials_with_beep, 0U);
    EXPECT_EQ(mean.curve().trials_without_beep, 1U);
    EXPECT_EQ(mean.curve().trials_without_entry, 2U);
    EXPECT_EQ(mean.curve().trials(), 1U);
    EXPECT_NEAR(mean.curve().needle[11].mean_percent, 100, 1e-9);  // the end is 100 %
    EXPECT_EQ(mean.curve().needle[12].trials, 0U);                 // and nothing is known of 110 %
    EXPECT_TRUE(std::isnan(mean.curve().example_needle_percent[12]));
}

TEST(MeanTrajectory, PointsBeforeTheTrialBeganAreNotInvented) {
    MeanTrajectory mean(13);
    mean.add(ramp(0.1, 10, 0.12, 12, 1));  // -10 % would be 0.89 s before the start
    EXPECT_EQ(mean.curve().needle[0].trials, 0U);
    EXPECT_EQ(mean.curve().needle[1].trials, 1U);
}

TEST(TrajectoryPanels, OnePerModalityAndDelay) {
    TrajectoryPanels panels;
    TrialRecord record = make_record([](double) { return 0.001; });
    panels.add(record);
    record.conditions.delay_s = 0.05;
    panels.add(record);
    panels.add(record);
    record.conditions.modality = Modality::kVF;
    panels.add(record);
    ASSERT_EQ(panels.panels().size(), 3U);
    EXPECT_EQ(panels.panels()[1].mean.curve().trials(), 2U);
}

}  // namespace
}  // namespace thimble
