#include "study/fit/calibration.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/statistics/distributions.hpp"
#include "common/math/portable.hpp"
#include "study/fit/fit_summary.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

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

}  // namespace

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

}  // namespace thimble
