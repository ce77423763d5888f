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

constexpr std::size_t kDistinctKeys = 11;

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

// The three parts of CCF's reaction are one trait: their numbers are the same, and count once.
std::vector<KeyCalibration> distinct(const std::vector<KeyCalibration>& keys) {
    std::vector<KeyCalibration> once;
    once.reserve(keys.size());
    for (const KeyCalibration& key : keys) {
        const bool again =
            key.key == "operator.reaction_crossing_s" || key.key == "operator.reaction_compatibility_s";
        if (!again) once.push_back(key);
    }
    return once;
}

// The level of .01 is shared by all keys. A coverage of 90 % has a standard error of 1.3 % with 500 people.
void expect_each_calibrated(const std::vector<KeyCalibration>& keys) {
    EXPECT_EQ(keys.size(), kDistinctKeys);
    for (const KeyCalibration& key : keys) {
        EXPECT_GT(key.p_uniform, 0.01 / kDistinctKeys) << key.key;
        EXPECT_GE(key.coverage, 0.84) << key.key;
        EXPECT_LE(key.coverage, 0.95) << key.key;
    }
}

// With few people and few simulations only a gross mistake shows.
void expect_no_gross_mistake(const std::vector<KeyCalibration>& keys) {
    EXPECT_EQ(keys.size(), kDistinctKeys);
    std::size_t uniform = 0;
    double covered = 0;
    for (const KeyCalibration& key : keys) {
        uniform += key.p_uniform > 0.01;
        covered += key.coverage / static_cast<double>(keys.size());
    }
    EXPECT_GE(uniform, 8U);
    EXPECT_GE(covered, 0.7);
}

// tests/nightly/proofs raises both numbers: 1000 people, as Talts and others have it.
TEST(FitCalibration, RanksAreUniformAndIntervalsCover) {
    const std::size_t people = from_environment("THIMBLE_CALIBRATIONS", 8);
    const std::size_t trials = from_environment("THIMBLE_FIT_SIMULATIONS", 160);
    const SystemSettings settings;
    const auto groups = fit_groups(subject_trials(experiment_1(settings, 1, 1), 1));
    const OperatorModel model(settings.person, groups, train(settings, groups, trials / 2));
    const std::vector<KeyCalibration> keys = calibrate(settings, model, 3, people, thread_count(0));
    for (const KeyCalibration& key : keys) {
        fmt::print("{:<42} P = {:.4f}, {:.1f} % in the 90 % interval, narrowed by {:.0f} %\n", key.key,
                   key.p_uniform, 100 * key.coverage, 100 * key.narrowed);
    }
    if (people >= 500)
        expect_each_calibrated(distinct(keys));
    else
        expect_no_gross_mistake(distinct(keys));
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
    trials.reserve(force.size());
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
