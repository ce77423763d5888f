// Predicts the features of trials of one condition from a person's traits. Simulated trials teach it: a quadratic regression of the
// features on the traits, and the scatter about it. It replaces the simulation where a fit needs it a million times
// (synthetic likelihood: S. N. Wood, "Statistical inference for noisy nonlinear ecological dynamic systems", Nature 466, 2010).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/statistics/cholesky.hpp"
#include "session/records/trial_record.hpp"
#include "study/fit/traits.hpp"

namespace thimble {

// The features of one trial that a fit compares: seven natural logarithms of times (s), depths (m) and speeds (m/s)
// of the needle. No number depends on the place of the fixture.
inline constexpr std::array<std::string_view, 7> kFeatureNames{
    "speed",       // of the insertion, before the contact with the fixture
    "slowing",     // from the touch of the tissue until the needle slows down
    "depth",       // of the penetration of the fixture, mean from one second after the contact to the beep
    "stopping",    // from the contact to nine tenths of that depth
    "wander",      // rms about that mean
    "tremble",     // rms of the movement within 50 ms
    "withdrawal",  // from the beep until the needle moves out
};
using TrialFeatures = std::array<double, kFeatureNames.size()>;

// None if the trial lacks a puncture, a contact, a beep or the samples around them. `samples` in order of time.
std::optional<TrialFeatures> trial_features(std::span<const TrajectorySample> samples,
                                            double fixture_position_m, double beep_time_s);

// Two simulated trials of a person who has no other. They tell how trials of one person differ, and with that how far the regression
// is from the mean of many trials.
struct SimulatedPair {
    TraitScores traits{};
    TrialFeatures first{}, second{};
};

// The mean features of a person's trials.
struct FeatureMean {
    TrialFeatures mean{};
    std::size_t trials = 0;

    void add(const TrialFeatures& features);
};

class Emulator {
  public:
    // `acting`: the traits that can do something in these trials. Throws Error (run failed) with fewer pairs than kFewestPairs.
    static constexpr std::size_t kFewestPairs = 20;
    Emulator(std::span<const SimulatedPair> pairs, std::vector<std::size_t> acting);

    // The factor of the covariance of a mean of that many trials, in units of the scales.
    Cholesky covariance(std::size_t trials) const;
    // Log likelihood that a person has this mean; `covariance` is that of as many trials.
    double log_likelihood(const TraitScores& traits, const FeatureMean& mean,
                          const Cholesky& covariance) const;
    // A mean of as many trials of that person as `covariance` has. `normals`: standard normal numbers, one per feature.
    TrialFeatures predict(const TraitScores& traits, const TrialFeatures& normals,
                          const Cholesky& covariance) const;

  private:
    struct At {
        TrialFeatures mean{}, scale{};
        double log_scales = 0;  // sum of their logarithms
        double uncertainty =
            0;  // of the regression, in squares of the scale: more where few pairs were simulated
    };
    At at(const TraitScores& traits) const;
    std::vector<double> terms(const TraitScores& traits) const;
    void fit_means(std::span<const SimulatedPair> pairs);
    void fit_scales(std::span<const SimulatedPair> pairs);
    void fit_covariances(std::span<const SimulatedPair> pairs);

    std::vector<std::size_t> acting_;
    std::vector<TrialFeatures> slopes_;        // of each term
    std::optional<Cholesky> information_;      // of the terms
    std::vector<TrialFeatures> scale_slopes_;  // log scale: a constant, then each acting trait
    std::vector<double> of_pairs_,
        within_;  // covariances: of means of two about the regression, of one person's trials
};

}  // namespace thimble
