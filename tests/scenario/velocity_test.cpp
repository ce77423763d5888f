// The whole loop with each velocity estimator: the trial ends as it should, nothing allocates, and the choice
// is felt where it belongs, at the tissue.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/allocation_count.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::seconds;

SystemSettings settings_with(VelocityMethod method) {
    SystemSettings settings = paper();
    settings.master.velocity.method = method;
    return settings;
}

class WithEstimator : public testing::TestWithParam<VelocityMethod> {};

TEST_P(WithEstimator, ATrialEndsWithTheBeepInTheFixtureAndNothingAllocates) {
    VirtualSession session(settings_with(GetParam()));
    session.start(trial_of(Modality::kHF));
    while (session.loop().now() < SessionTime{seconds{1}} && session.step()) {
    }
    const std::uint64_t before = allocation_count();
    while (session.step()) {
    }
    EXPECT_EQ(allocation_count() - before, 0U);
    const TrialRecord& record = session.session().record();
    ASSERT_EQ(record.reason, EndReason::kCompleted);
    const TrialMetrics metrics = measure(record);
    EXPECT_TRUE(metrics.beeped);
    EXPECT_FALSE(metrics.oscillates);
    EXPECT_GT(metrics.penetration_max_m, 1e-4);
    EXPECT_LT(metrics.penetration_max_m, 3e-3);
}

INSTANTIATE_TEST_SUITE_P(Each, WithEstimator,
                         testing::Values(VelocityMethod::kLowPass, VelocityMethod::kRaw,
                                         VelocityMethod::kWindowed, VelocityMethod::kFoaw,
                                         VelocityMethod::kKalman),
                         [](const auto& test) {
                             return std::string(kVelocityMethodNames[static_cast<std::size_t>(test.param)]);
                         });

TEST(VelocityChoice, ReachesTheTissue) {
    const TrialRecord low_pass =
        run_virtual_trial(settings_with(VelocityMethod::kLowPass), trial_of(Modality::kHF));
    const TrialRecord windowed =
        run_virtual_trial(settings_with(VelocityMethod::kWindowed), trial_of(Modality::kHF));
    EXPECT_FALSE(same_samples(low_pass, windowed));
}

TEST(VelocityChoice, OfASessionFileReachesTheLoop) {
    const ConfigFile file =
        ConfigFile::parse("[master]\nvelocity_estimator = \"windowed\"\nvelocity_window_s = 0.02\n", "test");
    const TrialRecord from_file = run_virtual_trial(read_system_settings(file), trial_of(Modality::kHF));
    const TrialRecord from_code =
        run_virtual_trial(settings_with(VelocityMethod::kWindowed), trial_of(Modality::kHF));
    EXPECT_TRUE(same_samples(from_file, from_code));
}

}  // namespace
}  // namespace thimble::test
