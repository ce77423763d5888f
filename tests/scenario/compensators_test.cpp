// Delay compensators with all nodes, in virtual time.
#include <array>
#include <cmath>
#include <fstream>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/records/metrics.hpp"
#include "session/virtual/virtual_session.hpp"
#include "stability/delayed_loop.hpp"
#include "study/compensators/compensator_report.hpp"
#include "study/compensators/compensator_table.hpp"
#include "study/with_compensator.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<CompensatorRow> compare(const std::vector<std::string>& names,
                                    const std::vector<double>& delays_s, std::uint32_t subjects,
                                    const SystemSettings& settings = paper()) {
    CompensatorStudyOptions options;
    options.names = names;
    options.networks = plain_networks(delays_s);
    options.subjects = subjects;
    return run_compensator_study(settings, options);
}

TEST(Compensators, EachCompletesAt50msWithoutTheOscillationOfTheHandle) {
    std::vector<std::string> names{"HF"};
    for (std::size_t i = 1; i < kBuiltInCompensators.size(); ++i) {
        if (static_cast<Compensator>(i) != Compensator::kTwoPort) names.emplace_back(kCompensatorNames[i]);
    }
    for (const CompensatorRow& row : compare(names, {0.05}, 2)) {
        EXPECT_EQ(row.trials, 2U);
        EXPECT_EQ(row.completed, 2U) << row.name;
        EXPECT_EQ(row.oscillating, row.name == "HF" ? 2U : 0U) << row.name;
        if (row.name != "HF") {
            EXPECT_LT(row.oscillation_peak_to_peak_m, 10e-3) << row.name;
        }
    }
}

// The hand stands further than the needle by force x delay / 2b with waves only.
TEST(Compensators, OnlyWavesLetHandAndNeedleApart) {
    for (const CompensatorRow& row : compare({"wave", "two-layer", "local-fixture"}, {0.05}, 2))
        EXPECT_EQ(row.drift_needle_m > 0.5e-3, row.name == "wave") << row.name << ' ' << row.drift_needle_m;
}

TEST(Compensators, WavesGetThroughLossAndJitterByPlayOut) {
    SystemSettings settings = paper();
    settings.netem.force.jitter = {JitterShape::kUniform, std::chrono::milliseconds{2}};
    settings.netem.force.loss = settings.netem.needle.loss = LossSettings::independent(0.05);
    settings.master.control.compensator = Compensator::kWave;
    settings.master.control.jitter = std::chrono::milliseconds{5};
    const auto rows = compare({"wave"}, {0.02}, 2, settings);
    EXPECT_EQ(rows.front().completed, 2U);
    EXPECT_EQ(rows.front().oscillating, 0U);
}

// In CF no compensator is in the loop, on neither side.
TEST(Compensators, ChangeNothingInOtherModalities) {
    const SystemSettings waves = with_control(paper(), control_for(paper(), Compensator::kWave));
    for (const Modality modality : {Modality::kCF, Modality::kHF}) {
        SCOPED_TRACE(to_string(modality));
        const bool other = modality == Modality::kCF;
        const TrialRecord a = run_virtual_trial(paper(), trial_of(modality, kPaperDelay));
        const TrialRecord b = run_virtual_trial(waves, trial_of(modality, kPaperDelay));
        EXPECT_EQ(same_samples(a, b), other);
        EXPECT_EQ(a.conditions.compensator, Compensator::kNone);
        EXPECT_EQ(b.conditions.compensator, other ? Compensator::kNone : Compensator::kWave);
    }
}

TEST(Compensators, DoNotDependOnTheNumberOfThreads) {
    CompensatorStudyOptions options;
    options.names = {"wave", "scaled"};
    options.networks = plain_networks({0.025});
    options.subjects = 2;
    options.jobs = 1;
    const auto alone = run_compensator_study(paper(), options);
    options.jobs = 3;
    const auto together = run_compensator_study(paper(), options);
    ASSERT_EQ(alone.size(), together.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
        EXPECT_EQ(alone[i].penetration_mean_m, together[i].penetration_mean_m);
        EXPECT_EQ(alone[i].drift_needle_m, together[i].drift_needle_m);
        EXPECT_EQ(std::isfinite(alone[i].share), alone[i].name == "scaled") << "the others choose no share";
        if (alone[i].name == "scaled") {
            EXPECT_EQ(alone[i].share, together[i].share);
        }
    }
    options.names = {"waves"};
    EXPECT_THROW(run_compensator_study(paper(), options), Error);
}

// An interrupted comparison goes on to the same bytes, and no other one goes on in its folder.
TEST(Compensators, TheTableOfTrialsIsGoneOnWith) {
    const TemporaryDirectory folder;
    const auto path = folder / "trials.csv";
    CompensatorStudyOptions options;
    options.names = {"CF", "scaled"};
    options.networks = plain_networks({0.01});
    options.subjects = 2;
    const auto conditions = chosen_conditions(paper(), options.names);
    const auto run = [&](std::size_t done) {
        std::vector<CompensatorTrial> trials = plan_compensator_trials(paper(), options);
        EXPECT_EQ(trials.size(), 4U);
        CompensatorTrialTable table(path, conditions, trials);
        EXPECT_EQ(table.done(), done);
        run_compensator_trials(paper(), options, std::span(trials).subspan(done),
                               [&](const CompensatorTrial& trial) { table.append(trial); });
        return trials;
    };
    const std::vector<CompensatorTrial> trials = run(0);
    const std::string whole = read_text(path);
    EXPECT_THAT(whole, HasSubstr("CF,10 ms,0.01,0,0,1,1,,1,")) << "CF has no share of a force";
    write_text(path, whole.substr(0, whole.rfind(',', whole.size() - 40)));
    const std::vector<CompensatorTrial> again = run(3);
    EXPECT_EQ(read_text(path), whole);
    EXPECT_EQ(compensator_rows_csv(condense(paper(), options, again)),
              compensator_rows_csv(condense(paper(), options, trials)));
    options.networks = plain_networks({0.02});
    std::vector<CompensatorTrial> other = plan_compensator_trials(paper(), options);
    std::ofstream(path, std::ios::binary | std::ios::app) << "wave,";
    EXPECT_THROW(CompensatorTrialTable(path, conditions, other), Error);
    EXPECT_EQ(read_text(path), whole + "wave,");
}

CompensatorRow row_of(const char* name, const CompensatorNetwork& network, double depth_m) {
    CompensatorRow row;
    row.name = name;
    row.network = network;
    row.trials = row.completed = 3;
    row.penetration_max_m = row.oscillation_peak_to_peak_m = row.drift_needle_m = depth_m;
    row.completion_time_s = 10;
    row.rendered_stiffness = 0.5;
    return row;
}

TEST(Compensators, FindingsSayWhereCfIsNotBest) {
    std::vector<CompensatorTrial> trials;
    std::vector<CompensatorRow> rows;
    const CompensatorNetwork network{"50 ms", 0.05, 0, 0};
    const double depth_mm[] = {9, 5, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        rows.push_back(row_of(std::array{"HF", "CF", "wave"}[c], network, depth_mm[c] / 1000));
        rows.back().oscillating = c == 0 ? 3 : 0;
        for (std::uint32_t subject = 1; subject <= 3; ++subject) {
            CompensatorTrial trial;
            trial.condition = c;
            trial.network = network;
            trial.conditions.subject = subject;
            trial.metrics.penetration_max_m = (depth_mm[c] + 0.1 * subject * static_cast<double>(c)) / 1000;
            trials.push_back(trial);
        }
    }
    std::string text;
    for (const std::string& sentence : compensator_findings(rows, trials)) text += sentence + '\n';
    EXPECT_THAT(text, HasSubstr("HF without a compensator oscillates in 3 of 3 over 50 ms (3 completed)."));
    EXPECT_THAT(text, HasSubstr("completed and none oscillated: CF, wave."));
    EXPECT_THAT(
        text, HasSubstr("CF is not best in maximum penetration: 5.00 mm, 2nd of the 2 stable; wave has 1.00 "
                        "mm, less by 3.80 mm"));
    EXPECT_THAT(text, Not(HasSubstr("HF (50 ms")));  // what HF does is the first sentence's
}

TEST(Compensators, AllFiguresAreDrawn) {
    std::vector<CompensatorRow> rows;
    for (const char* name : {"CF", "wave"}) {
        for (const CompensatorNetwork& network : standard_networks())
            rows.push_back(row_of(name, network, 1e-3));
    }
    std::vector<FigureSource> sources = delay_figures(rows);
    ASSERT_EQ(sources.size(), compensator_measures().size());
    sources.push_back(matrix_figure(rows));
    const TemporaryDirectory folder;
    const DrawnFigures drawn = draw_figures(sources, folder / "out");
    if (drawn.problem.find("cannot start") != std::string::npos) GTEST_SKIP() << drawn.problem;
    EXPECT_EQ(drawn.problem, "");
    EXPECT_EQ(drawn.figures.size(), sources.size());
}

// Passive, and of no use before a forbidden region: the proxy is led out and the hand goes on in.
TEST(Compensators, TwoPortPassivityDriftsApartWithDelay) {
    const auto rows = compare({"HF", "two-port"}, {0, 0.1}, 1);
    ASSERT_EQ(rows.size(), 4U);
    const CompensatorRow &without_delay = rows[2], &with_delay = rows[3];
    EXPECT_EQ(without_delay.completed, 1U);
    EXPECT_LT(without_delay.drift_needle_m, 1e-3);
    EXPECT_GT(with_delay.drift_needle_m, 5e-3);
    EXPECT_EQ(with_delay.oscillating, 0U);
}

// The virtual operator's arm, led by the skin: the limit falls with the lag, near that of one mass on a spring.
TEST(Compensators, ThePersonsOwnLoopHasALimitNearTheory) {
    for (const double lag_s : {0.2, 0.4}) {
        const double limit = perceptual_limit({1.45, 19, 350}, lag_s).gain_per_s;
        EXPECT_LT(operator_growth_per_s(paper(), lag_s, 0.8 * limit), 0) << lag_s;
        EXPECT_GT(operator_growth_per_s(paper(), lag_s, 1.6 * limit), 0) << lag_s;
    }
}

TEST(Compensators, TheStableShareFallsWithDelay) {
    double before = 1;
    EXPECT_EQ(stable_share(paper(), 0), 1);
    const auto soft = ConfigFile::parse("[fixture]\nstiffness_N_per_m = 0\n", "test");
    EXPECT_EQ(stable_share(read_system_settings(soft), 0.2), 1);
    for (const double delay_s : {0.01, 0.025, 0.05, 0.1, 0.2}) {
        const double share = stable_share(paper(), delay_s);
        EXPECT_LT(share, before) << delay_s;
        EXPECT_GT(share, 0.005) << delay_s;
        before = share;
    }
}

TEST(Compensators, OfASharedForceTheSkinGetsTheRest) {
    SystemSettings settings = paper();
    settings.master.control.compensator = Compensator::kScaled;
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
