#include "session/records/metrics.hpp"

#include <gtest/gtest.h>

#include "session/records/mean_trajectory.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TEST(Metrics, ConstantPenetration) {
    const TrialMetrics metrics = measure(make_record([](double) { return 0.004; }));
    EXPECT_NEAR(metrics.penetration_mean_m, 0.004, 1e-12);
    EXPECT_NEAR(metrics.penetration_max_m, 0.004, 1e-12);
    EXPECT_DOUBLE_EQ(metrics.puncture_time_s, kPuncture_s);
    EXPECT_DOUBLE_EQ(metrics.first_contact_time_s, kContact_s);
    EXPECT_DOUBLE_EQ(metrics.completion_time_s, kBeep_s - kPuncture_s);
    EXPECT_EQ(metrics.oscillation_rms_m, 0);
    EXPECT_EQ(metrics.oscillation_peak_to_peak_m, 0);
    EXPECT_TRUE(std::isnan(metrics.oscillation_frequency_Hz));
    EXPECT_TRUE(std::isnan(metrics.peak_displacement_m));
    EXPECT_EQ(metrics.contacts_lost, 0U);
    EXPECT_TRUE(metrics.beeped);
    EXPECT_FALSE(metrics.oscillates);
}

TEST(Metrics, SineInContactGivesAmplitudeAndFrequencyButDoesNotOscillate) {
    const TrialMetrics metrics = measure(sine_record(0.006, 0.003, 4));
    EXPECT_NEAR(metrics.penetration_mean_m, 0.006, 5e-6);
    EXPECT_NEAR(metrics.penetration_max_m, 0.009, 1e-9);
    EXPECT_NEAR(metrics.oscillation_rms_m, 0.003 / std::numbers::sqrt2, 1e-5);
    EXPECT_NEAR(metrics.oscillation_peak_to_peak_m, 0.006, 1e-6);
    EXPECT_NEAR(metrics.oscillation_frequency_Hz, 4, 0.01);
    EXPECT_EQ(metrics.contacts_lost, 0U);
    EXPECT_FALSE(metrics.oscillates);  // never leaves the fixture
}

TEST(Metrics, SineAcrossTheFixtureOscillates) {
    const TrialMetrics metrics = measure(sine_record(0, 0.003, 4));
    // One loss per period, at a quarter of it: 20 in the 5 s from contact to beep.
    EXPECT_EQ(metrics.contacts_lost, 20U);
    EXPECT_TRUE(metrics.oscillates);
    // The mean of the positive half of a sine: 2/pi of its amplitude.
    EXPECT_NEAR(metrics.penetration_mean_m, 0.003 * 2 / std::numbers::pi, 1e-5);
}

TEST(Metrics, ManySmallLossesAreNoOscillation) {
    const TrialMetrics metrics = measure(sine_record(0, 0.001, 4));  // rms 0.7 mm, the sway of a hand
    EXPECT_EQ(metrics.contacts_lost, 20U);
    EXPECT_FALSE(metrics.oscillates);
}

TEST(Metrics, LargeMovementWithOneLossIsNoOscillation) {
    const auto lost_n_times = [](int n) {
        return measure(make_record([n](double time_s) {
            const bool away = time_s - std::floor(time_s) >= 0.5 && time_s < n;
            return away ? -0.01 : 0.005;
        }));
    };
    EXPECT_EQ(lost_n_times(1).contacts_lost, 1U);
    EXPECT_GT(lost_n_times(1).oscillation_rms_m, kOscillationRms_m);
    EXPECT_FALSE(lost_n_times(1).oscillates);
    EXPECT_EQ(lost_n_times(2).contacts_lost, 2U);
    EXPECT_TRUE(lost_n_times(2).oscillates);
    EXPECT_EQ(lost_n_times(4).contacts_lost, 4U);
}

TEST(Metrics, ArrivalAndWithdrawalAreNoOscillation) {
    const TrialMetrics metrics = measure(make_record([](double time_s) {
        if (time_s < 0.4) return 0.02 - 0.04 * time_s;
        return time_s > 5 ? -0.1 : 0.004;
    }));
    EXPECT_EQ(metrics.oscillation_peak_to_peak_m, 0);
    EXPECT_EQ(metrics.contacts_lost, 0U);
    EXPECT_NEAR(metrics.penetration_max_m, 0.02, 1e-12);
}

TEST(Metrics, RippleOnALargeOscillationIsNotCounted) {
    const TrialMetrics metrics = measure(make_record([](double time_s) {
        const double turn = 2 * std::numbers::pi * time_s;
        // Large enough to cross the mean several times in each period of the oscillation.
        return 0.02 + 0.01 * std::cos(2 * turn) + 0.002 * std::cos(90 * turn);
    }));
    EXPECT_NEAR(metrics.oscillation_frequency_Hz, 2, 0.05);
}

TEST(Metrics, AFewEncoderStepsHaveNoFrequency) {
    EXPECT_TRUE(std::isnan(measure(sine_record(0.004, 0.08e-3, 5)).oscillation_frequency_Hz));
    EXPECT_NEAR(measure(sine_record(0.004, 0.1e-3, 5)).oscillation_frequency_Hz, 5, 0.02);
}

TEST(Metrics, WithoutBeepToTheEnd) {
    TrialRecord record = make_record([](double time_s) { return time_s < 5 ? 0.001 : 0.003; }, 12.0);
    record.beep_time_s = std::numeric_limits<double>::quiet_NaN();
    const TrialMetrics metrics = measure(record);
    EXPECT_FALSE(metrics.beeped);
    EXPECT_TRUE(std::isnan(metrics.completion_time_s));
    EXPECT_NEAR(metrics.penetration_max_m, 0.003, 1e-12);
    EXPECT_NEAR(metrics.penetration_mean_m, 0.002, 1e-6);
}

TEST(Metrics, FixtureRemoved) {
    // Held at 2 mm, removed at 7.5 s, the needle falls to 22 mm beyond where the fixture was.
    TrialRecord record = make_record([](double time_s) { return time_s < 5.5 ? 0.002 : 0.022; }, 9.0);
    for (TrajectorySample& sample : record.samples) sample.fixture_present = sample.time_s < 7.5;
    EXPECT_NEAR(measure(record).peak_displacement_m, 0.020, 1e-9);

    record.beep_time_s = std::numeric_limits<double>::quiet_NaN();
    const TrialMetrics without_beep = measure(record);
    EXPECT_NEAR(without_beep.penetration_max_m, 0.002, 1e-12);  // free space is not penetration
    EXPECT_EQ(without_beep.contacts_lost, 0U);
}

TEST(Metrics, OnlyTheFiveSecondsBeforeRemovalCount) {
    // 1 mm at first, 3 mm for the last five seconds.
    TrialRecord record = make_record(
        [](double time_s) {
            if (time_s < 2) return 0.001;
            return time_s < 7 ? 0.003 : 0.013;
        },
        10.0);
    for (TrajectorySample& sample : record.samples) sample.fixture_present = sample.time_s < 9.0;
    EXPECT_NEAR(measure(record).peak_displacement_m, 0.010, 1e-9);
}

TEST(Metrics, EmptyTinyAndContactlessRecords) {
    const TrialMetrics nothing = measure(TrialRecord{});
    EXPECT_TRUE(std::isnan(nothing.penetration_mean_m));
    EXPECT_TRUE(std::isnan(nothing.first_contact_time_s));
    EXPECT_FALSE(nothing.oscillates);

    TrialRecord one;
    one.conditions.fixture_position_m = 0.1;
    one.samples.push_back({.time_s = 0.5, .position_needle_m = 0.101});
    const TrialMetrics single = measure(one);
    EXPECT_NEAR(single.penetration_max_m, 0.001, 1e-12);
    EXPECT_TRUE(std::isnan(single.oscillation_rms_m));  // nothing 0.5 s after the first contact

    one.samples.front().position_needle_m = one.conditions.fixture_position_m;
    EXPECT_TRUE(std::isnan(measure(one).first_contact_time_s)) << "it only reaches the plane";

    const TrialMetrics free = measure(make_record([](double) { return -0.01; }));
    EXPECT_TRUE(std::isnan(free.penetration_max_m));
    EXPECT_DOUBLE_EQ(free.completion_time_s, 6.0);
}

TEST(MeanTrajectory, IdenticalTrialsHaveNoSpread) {
    MeanTrajectory mean;
    TrialRecord record = sine_record(0.004, 0.003, 1.3);
    for (std::uint32_t i = 0; i < 7; ++i) {
        record.conditions.subject = 1 + i / 2;
        mean.add(record);
    }
    const MeanCurve curve = mean.curve();
    ASSERT_EQ(curve.mean.needle.size(), kContactGrid.points);
    EXPECT_EQ(curve.subjects, 4U);
    EXPECT_EQ(curve.trials_with_beep, 7U);
    for (std::size_t i = 0; i < curve.grid.points; ++i) {
        if (std::isnan(curve.example_needle_percent[i])) continue;
        ASSERT_EQ(curve.mean.needle[i].n, 4U);
        ASSERT_EQ(curve.mean.needle[i].sd(), 0);
        ASSERT_EQ(curve.mean.surface[i].sd(), 0);
        ASSERT_EQ(curve.mean.needle[i].mean, curve.example_needle_percent[i]);
    }
}

constexpr double kRest_m = 0.02;  // of the surface

// Needle as deep as time has passed, from the surface at `entry_s` through the fixture at `contact_s`.
TrialRecord ramp(double entry_s, double contact_s, double beep_s, double fixture_m, int step_ms = 1) {
    TrialRecord record;
    record.conditions.fixture_position_m = fixture_m;
    record.beep_time_s = beep_s;
    for (int i = 0; i <= static_cast<int>((beep_s + 2) * 1000); i += step_ms) {
        TrajectorySample sample;
        sample.time_s = i / 1000.0;
        sample.position_needle_m =
            std::lerp(kRest_m, fixture_m, (sample.time_s - entry_s) / (contact_s - entry_s));
        sample.position_surface_m = kRest_m;
        sample.phase = sample.time_s >= entry_s ? TissuePhase::kPenetrated : TissuePhase::kFree;
        record.samples.push_back(sample);
    }
    return record;
}

// 0 % is the surface at rest and not the handle's zero; time runs from the first sample beyond the fixture.
TEST(MeanTrajectory, TimeRunsFromContactAndDepthFromTheSurface) {
    constexpr CurveGrid kGrid{CurveAxis::kFromContact, -2, 2, 5};
    const TrialCurve curve = trial_curve(ramp(2, 4, 8, 0.11), kGrid);
    ASSERT_TRUE(curve.placed);
    EXPECT_NEAR(curve.entry, -2, 2e-3);
    EXPECT_NEAR(curve.beep, 4, 2e-3);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(curve.needle_percent[i], 50.0 * static_cast<double>(i), 0.06);
        EXPECT_EQ(curve.surface_percent[i], 0);
    }
}

TEST(MeanTrajectory, OnThePercentAxisTrialsOfAnyLengthAreOne) {
    constexpr CurveGrid kGrid{CurveAxis::kEntryToBeep, 0, 100, 11};
    MeanTrajectory mean(kGrid);
    mean.add(ramp(2, 6, 10, 0.11));
    mean.add(ramp(1, 3.5, 6, 0.13, 10));
    const MeanCurve curve = mean.curve();
    for (std::size_t i = 0; i < 11; ++i) {
        EXPECT_NEAR(curve.mean.needle[i].mean, 20.0 * static_cast<double>(i), 1e-9);
        EXPECT_NEAR(curve.mean.needle[i].sd(), 0, 1e-9);
    }
    EXPECT_NEAR(curve.mean.entry.mean, 0, 1e-9);
    EXPECT_NEAR(curve.mean.beep.mean, 100, 1e-9);
}

TEST(MeanTrajectory, ACurveHasItsEndsAndTwoSamplesOfOneTime) {
    constexpr CurveGrid kGrid{CurveAxis::kEntryToBeep, 0, 100, 3};
    TrialRecord record = ramp(0, 2, 4, 0.11);
    record.beep_time_s = TrialCurve::kNone;  // so that the axis ends with the last sample
    record.samples.insert(record.samples.begin(), record.samples.front());
    const TrialCurve curve = trial_curve(record, kGrid);
    EXPECT_EQ(curve.needle_percent[0], 0);
    EXPECT_EQ(curve.needle_percent[2], 300);
}

// Means of subjects 1, 2 and 3: 101, 102 and 106 %, however many trials each has; the spread is theirs.
TEST(MeanTrajectory, SpreadsOverSubjectsWhoseTrialsAreAveragedFirst) {
    constexpr CurveGrid kGrid{CurveAxis::kFromContact, 0, 1, 2};
    MeanTrajectory mean(kGrid);
    const auto add = [&](std::uint32_t subject, double percent) {
        TrialRecord record = make_record([](double) { return 0.001; });
        record.conditions.subject = subject;
        TrialCurve curve = trial_curve(record, kGrid);
        curve.needle_percent[0] = percent;
        mean.add(curve);
    };
    for (const double percent : {99.0, 103.0}) add(1, percent);
    EXPECT_DOUBLE_EQ(mean.curve().mean.needle[0].sd(), std::sqrt(8)) << "of one subject: over the trials";
    EXPECT_EQ(mean.curve().n(), 2U);
    add(2, 102);
    for (const double percent : {104.0, 106.0, 108.0}) add(3, percent);
    const MeanCurve curve = mean.curve();
    EXPECT_EQ(curve.n(), 3U);
    EXPECT_EQ(curve.trials(), 6U);
    EXPECT_DOUBLE_EQ(curve.mean.needle[0].mean, 103);
    EXPECT_DOUBLE_EQ(curve.mean.needle[0].sd(), std::sqrt((4 + 1 + 9) / 2.0));
}

TEST(MeanTrajectory, TrialsWithoutBeepOrWithoutTheirBeginningAreCountedApart) {
    MeanTrajectory touched, entered(kPercentGrid);
    const auto add = [&](const TrialRecord& record) {
        touched.add(record);
        entered.add(record);
    };
    TrialRecord timeout = ramp(2, 4, 8, 0.12);
    timeout.beep_time_s = kNaN;
    add(timeout);
    TrialRecord never_touched = ramp(2, 4, 8, 0.12);
    never_touched.conditions.fixture_position_m = 1;
    add(never_touched);
    TrialRecord never_entered = ramp(2, 4, 8, 0.12);
    for (TrajectorySample& sample : never_entered.samples) sample.phase = TissuePhase::kFree;
    add(never_entered);
    add(TrialRecord{});
    EXPECT_EQ(touched.curve().trials_without_beep, 1U);
    EXPECT_EQ(touched.curve().trials_with_beep, 1U);
    EXPECT_EQ(touched.curve().trials_left_out, 2U);
    EXPECT_EQ(entered.curve().trials_with_beep, 1U);
    EXPECT_EQ(entered.curve().trials_left_out, 2U);
}

TEST(MeanTrajectory, PointsOutsideTheTrialAreNotInvented) {
    MeanTrajectory mean;
    mean.add(ramp(1, 3, 8, 0.12));  // 3 s before contact, 7 s after it
    const MeanCurve curve = mean.curve();
    const auto n_at = [&](double time_s) {
        return curve.mean.needle[static_cast<std::size_t>(std::lround((time_s - curve.grid.begin) / 0.025))]
            .n;
    };
    EXPECT_EQ(n_at(-3.025), 0U);
    EXPECT_EQ(n_at(-2.975), 1U);
    EXPECT_EQ(n_at(6.975), 1U);
    EXPECT_EQ(n_at(7.025), 0U);
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
