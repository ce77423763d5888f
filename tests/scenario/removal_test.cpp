// Experiment 2: the fixture vanishes with the beep. A hand that pushed against it falls through, a hand that stood still does not.
#include <algorithm>

#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

TrialRecord removal(Modality modality) {
    TrialConditions trial = trial_of(modality);
    trial.experiment = 2;
    trial.removes_fixture = true;
    return run_virtual_trial(paper(), trial);
}

TEST(FixtureRemoval, HappensWithTheBeepAndNotBefore) {
    const TrialRecord record = removal(Modality::kHF);
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    ASSERT_TRUE(std::isfinite(record.beep_time_s));
    const auto gone = std::find_if(record.samples.begin(), record.samples.end(),
                                   [](const TrajectorySample& s) { return !s.fixture_present; });
    ASSERT_NE(gone, record.samples.end());
    EXPECT_GT(gone->time_s, record.beep_time_s);
    EXPECT_LT(gone->time_s, record.beep_time_s + 0.005);
    for (auto sample = gone; sample != record.samples.end(); ++sample) {
        EXPECT_FALSE(sample->fixture_present);
        EXPECT_EQ(sample->force_fixture_N, 0);
    }
}

TEST(FixtureRemoval, OnlyWhoPushedFallsThrough) {
    const double handle_m = measure(removal(Modality::kHF)).peak_displacement_m;
    EXPECT_GT(handle_m, 5e-3);
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        const double other_m = measure(removal(modality)).peak_displacement_m;
        EXPECT_LT(other_m, 2e-3) << to_string(modality);
        EXPECT_GT(handle_m, 5 * other_m) << to_string(modality);
    }
}

// Up to the beep the subject cannot know which trial it is.
TEST(FixtureRemoval, ChangesNothingBeforeTheBeep) {
    const TrialRecord with = removal(Modality::kCF);
    TrialConditions trial = with.conditions;
    trial.removes_fixture = false;
    const TrialRecord without = run_virtual_trial(paper(), trial);
    ASSERT_EQ(with.beep_time_s, without.beep_time_s);
    for (std::size_t i = 0; with.samples[i].time_s <= with.beep_time_s; ++i) {
        ASSERT_EQ(with.samples[i].position_needle_m, without.samples[i].position_needle_m);
        ASSERT_EQ(with.samples[i].force_total_N, without.samples[i].force_total_N);
    }
}

}  // namespace
}  // namespace thimble::test
