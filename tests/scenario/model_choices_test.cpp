// The whole loop with each velocity estimator: the trial ends as it should, nothing allocates, and the choice
// is felt where it belongs, at the tissue.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "master/master_node.hpp"
#include "session/records/metrics.hpp"
#include "session/virtual/virtual_session.hpp"
#include "slave_sim/slave_node.hpp"
#include "tests/allocation_count.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
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
    run_until(session, SessionTime{seconds{1}});
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

TEST(VelocityChoice, OfASessionFileReachesTheTissue) {
    const auto run = [](const SystemSettings& settings) {
        return run_virtual_trial(settings, trial_of(Modality::kHF));
    };
    const TrialRecord windowed = run(settings_with(VelocityMethod::kWindowed));
    EXPECT_FALSE(same_samples(run(settings_with(VelocityMethod::kLowPass)), windowed));
    EXPECT_TRUE(
        same_samples(run(read_system_settings(ConfigFile::parse(
                         "[master]\nvelocity_estimator = \"windowed\"\nvelocity_window_s = 0.02\n", "test"))),
                     windowed));
}

// A slow press on the tissue through the encoder. One count of the handle is 0.03 mm of needle; in one
// millisecond that looks like 30 mm/s, and B times that exceeds the puncture force. Only the velocity filter
// keeps the encoder from piercing what the hand does not.
constexpr double kPress_needle_m_per_s = 0.010;
constexpr double kDepth_m = 0.008;  // K x + B v stays below the puncture force of 0.1 N

// The first depth at which the tissue gives way, NaN if it holds.
double pierced_at_m(const SystemSettings& settings) {
    MasterNode master(settings.master);
    SlaveNode slave(settings.slave);
    SessionControl order;
    order.fixture_position_m = 0.123;
    master.start_trial({}, Modality::kHF);
    slave.start_trial(order);
    const double surface_m = settings.slave.scene.elements.front().position_m;
    const double scale = settings.master.position_scale, count_m = settings.handle.encoder_resolution_m;
    for (std::uint32_t ms = 0;; ++ms) {
        const double needle_m = surface_m - 0.002 + kPress_needle_m_per_s * 1e-3 * ms;
        if (needle_m > surface_m + kDepth_m) return std::nan("");
        const HandleSample sample{std::round(needle_m / scale / count_m) * count_m, 0};
        const SessionTime now{milliseconds{ms}};
        const ForceFeedback feedback = slave.on_needle(now, ms, master.sample(now, sample));
        if (feedback.phase == TissuePhase::kPenetrated) return needle_m - surface_m;
    }
}

TEST(Quantisation, OnlyTheRawDifferenceOfACoarseEncoderPierces) {
    for (std::size_t i = 0; i < kVelocityMethodNames.size(); ++i) {
        SCOPED_TRACE(kVelocityMethodNames[i]);
        SystemSettings settings = settings_with(static_cast<VelocityMethod>(i));
        const bool raw = settings.master.velocity.method == VelocityMethod::kRaw;
        EXPECT_EQ(pierced_at_m(settings) < 0.001, raw);
        EXPECT_EQ(std::isnan(pierced_at_m(settings)), !raw);
        settings.handle.encoder_resolution_m = 1e-9;  // it is the encoder, not the filter's lag
        EXPECT_TRUE(std::isnan(pierced_at_m(settings)));
    }
}

// Sessions in other scenes than the paper's, and by other solvers than the exact one.
SystemSettings with_slave(const std::string& keys) {
    return read_system_settings(ConfigFile::parse("[slave_sim]\n" + keys, "session.toml"));
}

double strongest_tissue_N(const TrialRecord& record) {
    double strongest_N = 0;
    for (const TrajectorySample& s : record.samples)
        strongest_N = std::max(strongest_N, std::abs(s.force_tissue_N));
    return strongest_N;
}

TEST(SceneInASession, AVesselOnTheWayIsFelt) {
    const TrialRecord without = run_virtual_trial(paper(), trial_of(Modality::kCF));
    const TrialRecord with =
        run_virtual_trial(with_slave("scene = 'vessel.toml'\n"), trial_of(Modality::kCF));
    ASSERT_EQ(without.reason, EndReason::kCompleted);
    ASSERT_FALSE(with.samples.empty());
    EXPECT_GT(strongest_tissue_N(with), strongest_tissue_N(without) + 0.1);
}

// At 10 us the rules are as good as exact for a whole trial: the same end, at the same time within a sample or two.
TEST(SceneInASession, EverySolverRunsATrial) {
    const TrialRecord reference = run_virtual_trial(paper(), trial_of(Modality::kHF));
    for (const char* solver : {"semi_implicit_euler", "rk4", "implicit_midpoint"}) {
        const TrialRecord record =
            run_virtual_trial(with_slave("solver = '" + std::string(solver) + "'\nsolver_step_s = 1e-5\n"),
                              trial_of(Modality::kHF));
        EXPECT_EQ(record.reason, reference.reason) << solver;
        EXPECT_NEAR(record.beep_time_s, reference.beep_time_s, 0.01) << solver;
    }
}

}  // namespace
}  // namespace thimble::test
