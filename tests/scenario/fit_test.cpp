// Fits of the virtual operator to itself: what was drawn for a person comes out of that person's trials.
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "session/settings/protocol.hpp"
#include "study/fit/calibration.hpp"
#include "study/fit/fit_summary.hpp"
#include "study/ordered_workers.hpp"

namespace thimble {
namespace {

std::size_t from_environment(const char* name, std::size_t otherwise) {
    const char* const text = std::getenv(name);
    return text != nullptr ? std::strtoul(text, nullptr, 10) : otherwise;
}

std::vector<std::optional<SimulatedPair>> train(const SystemSettings& settings,
                                                const std::vector<FitGroup>& groups, std::size_t pairs) {
    OrderedWorkers<std::optional<SimulatedPair>> workers(pairs, thread_count(0), [&](std::size_t i) {
        return simulate_pair(settings, training_pair(groups, 7, i));
    });
    std::vector<std::optional<SimulatedPair>> all;
    all.reserve(pairs);
    for (std::size_t i = 0; i < pairs; ++i) all.push_back(*workers.take());
    return all;
}

// tests/nightly/proofs raises both numbers: 1000 people, as Talts and others have it.
TEST(FitCalibration, RanksAreUniformAndIntervalsCover) {
    const std::size_t people = from_environment("THIMBLE_CALIBRATIONS", 8);
    const std::size_t trials = from_environment("THIMBLE_FIT_SIMULATIONS", 160);
    const SystemSettings settings;
    const auto groups = fit_groups(subject_trials(experiment_1(settings, 1, 1), 1));
    const OperatorModel model(settings.person, groups, train(settings, groups, trials / 2));
    std::size_t uniform = 0;
    double covered = 0;
    const std::vector<KeyCalibration> keys = calibrate(settings, model, 3, people, thread_count(0));
    for (const KeyCalibration& key : keys) {
        fmt::print("{:<42} P = {:.4f}, {:.1f} % in the 90 % interval, narrowed by {:.0f} %\n", key.key,
                   key.p_uniform, 100 * key.coverage, 100 * key.narrowed);
        uniform += key.p_uniform > 0.01;
        covered += key.coverage / static_cast<double>(keys.size());
    }
    EXPECT_GE(uniform, 8U);
    const bool many = people >= 500;
    EXPECT_GE(covered, many ? 0.87 : 0.7);
    EXPECT_LE(covered, many ? 0.93 : 1.0);
}

// Speed is what a trial shows best: a fit that does not find it finds nothing.
TEST(FitCalibration, FindsTheSpeedOfASlowPerson) {
    SystemSettings settings;
    const std::vector<TrialConditions> planned = subject_trials(experiment_1(settings, 1, 1), 1);
    std::vector<TrialConditions> force;
    for (const TrialConditions& conditions : planned)
        if (conditions.modality == Modality::kHF) force.push_back(conditions);
    const auto groups = fit_groups(force);
    const OperatorModel model(settings.person, groups, train(settings, groups, 30));
    SystemSettings slow = settings;
    slow.person.behaviour.speed_insert_needle_m_per_s *= 0.7;
    slow.person.spread = {0, 0, 0, 0, 0, 0, 0};
    std::vector<ObservedTrial> trials;
    for (const TrialConditions& conditions : force)
        trials.push_back({conditions, *simulate_trial(slow, conditions)});
    const KeySummary speed = summarise(fitted_keys(settings.person).front(), model.posterior(trials, 1, 300));
    EXPECT_LT(speed.low, 0.7 * 0.015);
    EXPECT_GT(speed.high, 0.7 * 0.015);
    EXPECT_LT(speed.high, 0.9 * 0.015);
    EXPECT_TRUE(speed.identifiable());
}

}  // namespace
}  // namespace thimble
