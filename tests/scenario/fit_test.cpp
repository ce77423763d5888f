// Fits of the virtual operator to itself: what was drawn for a person comes out of that person's trials.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "analysis/statistics/distributions.hpp"
#include "session/settings/protocol.hpp"
#include "study/fit/operator_model.hpp"
#include "study/fit/traits.hpp"
#include "study/ordered_workers.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

constexpr std::size_t kDistinctKeys = 11;

// Simulation-based calibration of a fit: people are drawn from the population, do their trials, and are fitted. Where the fit is
// right, the rank of each true value among the draws is uniform. S. Talts and others, "Validating Bayesian inference algorithms with
// simulation-based calibration", arXiv 1804.06788, 2018.
struct KeyCalibration {
    std::string key;
    double p_uniform = 0;  // chi squared over ten classes of ranks
    double coverage = 0;   // share of people whose value lies in the 90 % interval
    double narrowed = 0;   // mean of 1 - posterior SD / population SD, of the logarithm
};

// So that each of ten classes has as many ranks: 0 ... 99.
constexpr std::size_t kDraws = 99, kClasses = 10;
constexpr std::size_t kIntervalDraws = 1000;
// Other people than the model has learned from.
constexpr std::uint32_t kFirstPerson = 1'500'000;

struct Person {
    TraitScores truth{};
    std::array<TraitScores, kIntervalDraws> draws{};
};

Person fit_person(const SystemSettings& settings, const OperatorModel& model, std::uint64_t seed,
                  std::size_t r) {
    Person person;
    std::vector<ObservedTrial> trials;
    for (const FitGroup& group : model.groups()) {
        for (TrialConditions conditions : group.trials) {
            conditions.study_seed = seed;
            conditions.subject = kFirstPerson + static_cast<std::uint32_t>(r);
            const auto features = simulate_trial(settings, conditions);
            if (features) trials.push_back({conditions, *features});
            person.truth = traits_of(settings, conditions);
        }
    }
    const std::vector<TraitScores> draws = model.posterior(trials, seed + r, kIntervalDraws);
    std::copy(draws.begin(), draws.end(), person.draws.begin());
    return person;
}

class KeyTally {
  public:
    explicit KeyTally(FittedKey key) : key_(std::move(key)) {}

    void add(const Person& person) {
        const double truth = key_.value(person.truth);
        const KeySummary summary = summarise(key_, person.draws);
        covered_ += summary.low <= truth && truth <= summary.high;
        narrowed_ += summary.narrowed;
        std::size_t rank = 0;
        for (std::size_t i = 0; i < kDraws; ++i)
            rank += key_.value(person.draws[i * kIntervalDraws / kDraws]) < truth;
        ++classes_[rank * kClasses / (kDraws + 1)];
        ++people_;
    }

    KeyCalibration result() const {
        const double n = static_cast<double>(people_), expected = n / kClasses;
        double chi_squared = 0;
        for (const std::size_t count : classes_) {
            const double away = static_cast<double>(count) - expected;
            chi_squared += away * away / expected;
        }
        return {key_.key, chi_squared_upper(chi_squared, kClasses - 1), static_cast<double>(covered_) / n,
                narrowed_ / n};
    }

  private:
    FittedKey key_;
    std::array<std::size_t, kClasses> classes_{};
    std::size_t people_ = 0, covered_ = 0;
    double narrowed_ = 0;
};

// People r = 0 ... `people` - 1 do the trials of the model's groups on `jobs` threads.
std::vector<KeyCalibration> calibrate(const SystemSettings& settings, const OperatorModel& model,
                                      std::uint64_t seed, std::size_t people, unsigned jobs) {
    std::vector<KeyTally> tallies;
    for (FittedKey& key : fitted_keys(settings.person)) tallies.emplace_back(std::move(key));
    run_in_order<Person>(
        people, jobs, nullptr, [&](std::size_t r) { return fit_person(settings, model, seed, r); },
        [&](const Person& person) {
            for (KeyTally& tally : tallies) tally.add(person);
        });
    std::vector<KeyCalibration> results;
    results.reserve(tallies.size());
    for (const KeyTally& tally : tallies) results.push_back(tally.result());
    return results;
}

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
