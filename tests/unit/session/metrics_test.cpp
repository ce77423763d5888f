#include "session/records/metrics.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace thimble
