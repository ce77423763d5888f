// Remedies against delay with all nodes, in virtual time.
#include <algorithm>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "experiment/metrics.hpp"
#include "experiment/remedies/remedy_study.hpp"
#include "experiment/virtual_session.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

std::vector<RemedyRow> compare(const std::vector<std::string>& names, const std::vector<double>& delays_s,
                               std::uint32_t subjects, const SystemSettings& settings = paper()) {
    RemedyStudyOptions options;
    options.names = names;
    options.networks = plain_networks(delays_s);
    options.subjects = subjects;
    return run_remedy_study(settings, options);
}

TEST(Remedies, EachCompletesAt50msWithoutTheOscillationOfTheHandle) {
    std::vector<std::string> names{"HF"};
    for (std::size_t i = 1; i < kRemedyNames.size(); ++i) {
        if (static_cast<Remedy>(i) != Remedy::kTwoPort) names.emplace_back(kRemedyNames[i]);
    }
    for (const RemedyRow& row : compare(names, {0.05}, 2)) {
        EXPECT_EQ(row.trials, 2U);
        EXPECT_EQ(row.completed, 2U) << row.name;
        EXPECT_EQ(row.oscillating, row.name == "HF" ? 2U : 0U) << row.name;
        if (row.name != "HF") {
            EXPECT_LT(row.oscillation_peak_to_peak_m, 10e-3) << row.name;
        }
    }
}

// The hand stands further than the needle by force x delay / 2b; nothing else lets go of it.
TEST(Remedies, OnlyWavesLetHandAndNeedleApart) {
    for (const RemedyRow& row : compare({"wave", "two-layer", "local-fixture"}, {0.05}, 2)) {
        EXPECT_EQ(row.drift_needle_m > 0.5e-3, row.name == "wave") << row.name << ' ' << row.drift_needle_m;
    }
}

TEST(Remedies, WavesGetThroughLossAndJitterByPlayOut) {
    SystemSettings settings = paper();
    settings.netem.force.jitter = {JitterShape::kUniform, std::chrono::milliseconds{2}};
    settings.netem.force.loss = settings.netem.needle.loss = LossSettings::independent(0.05);
    settings.master.control.remedy = Remedy::kWave;
    settings.master.control.jitter = std::chrono::milliseconds{5};
    const auto rows = compare({"wave"}, {0.02}, 2, settings);
    EXPECT_EQ(rows.front().completed, 2U);
    EXPECT_EQ(rows.front().oscillating, 0U);
}

// In CF no remedy is in the loop, on neither side.
TEST(Remedies, ChangeNothingInOtherModalities) {
    SystemSettings waves = paper();
    waves.master.control.remedy = Remedy::kWave;
    waves.slave.wave = wave_end_of(waves.master.control, waves.slave.wave);
    for (const Modality modality : {Modality::kCF, Modality::kHF}) {
        const TrialRecord a = run_virtual_trial(paper(), trial_of(modality, kPaperDelay));
        const TrialRecord b = run_virtual_trial(waves, trial_of(modality, kPaperDelay));
        EXPECT_EQ(same_samples(a, b), modality == Modality::kCF) << to_string(modality);
    }
}

TEST(Remedies, DoNotDependOnTheNumberOfThreads) {
    RemedyStudyOptions options;
    options.names = {"wave", "scaled"};
    options.networks = plain_networks({0.025});
    options.subjects = 2;
    options.jobs = 1;
    const auto alone = run_remedy_study(paper(), options);
    options.jobs = 3;
    const auto together = run_remedy_study(paper(), options);
    ASSERT_EQ(alone.size(), together.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
        EXPECT_EQ(alone[i].penetration_mean_m, together[i].penetration_mean_m);
        EXPECT_EQ(alone[i].drift_needle_m, together[i].drift_needle_m);
        EXPECT_EQ(alone[i].share, together[i].share);
    }
    options.names = {"waves"};
    EXPECT_THROW(run_remedy_study(paper(), options), Error);
}

TEST(Remedies, TheStableShareFallsWithDelay) {
    double before = 1;
    EXPECT_EQ(stable_share(paper(), 0), 1);
    for (const double delay_s : {0.01, 0.025, 0.05, 0.1, 0.2}) {
        const double share = stable_share(paper(), delay_s);
        EXPECT_LT(share, before) << delay_s;
        EXPECT_GT(share, 0.005) << delay_s;
        before = share;
    }
}

TEST(Remedies, OfASharedForceTheSkinGetsTheRest) {
    SystemSettings settings = paper();
    settings.master.control.remedy = Remedy::kScaled;
    settings.master.control.share = 0.05;
    settings.cutaneous.hand_share = 0.05;
    const TrialMetrics with_skin = measure(run_virtual_trial(settings, trial_of(Modality::kHF, kPaperDelay)));
    settings.cutaneous.hand_share = 1;
    const TrialMetrics without = measure(run_virtual_trial(settings, trial_of(Modality::kHF, kPaperDelay)));
    ASSERT_TRUE(with_skin.beeped);
    EXPECT_LT(with_skin.penetration_max_m, without.penetration_max_m - 1e-3);
}

}  // namespace
}  // namespace thimble::test
