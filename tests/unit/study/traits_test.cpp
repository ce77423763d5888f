// A fit estimates the traits that a virtual subject draws.
#include "study/fit/traits.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace thimble {
namespace {

double value_of(const OperatorParameters& population, const Subject& subject, const std::string& key) {
    for (const FittedKey& fitted : fitted_keys(population))
        if (fitted.key == key) return fitted.value(trait_scores(population, subject));
    ADD_FAILURE() << key << " is not fitted";
    return 0;
}

TEST(Traits, KeysHaveTheValuesOfTheDrawnSubject) {
    const OperatorParameters population;
    const Subject s = draw_subject(population, 11, 1, 7);
    const auto near = [&](const std::string& key, double value) {
        EXPECT_NEAR(value_of(population, s, "operator." + key), value, 1e-12 * value) << key;
    };
    near("speed_insert_needle_m_per_s", s.speed_insert_needle_m_per_s);
    near("arm_stiffness_N_per_m", s.arm_stiffness_N_per_m);
    near("grip_stiffness_N_per_m", s.grip_stiffness_N_per_m);
    near("criterion_N", s.criterion_N);
    near("sway_m", s.sway_m);
    const auto reaction = [&](Modality modality) {
        return s.reaction_factor * s.reaction_modality_factor[static_cast<std::size_t>(modality)];
    };
    near("reaction_handle_s", population.reaction.handle_s * reaction(Modality::kHF));
    near("reaction_tactile_s", population.reaction.tactile_s * reaction(Modality::kCCF));
    near("reaction_visual_s", population.reaction.visual_s * reaction(Modality::kVF));
    near("reaction_auditory_s", population.reaction.auditory_s * s.reaction_factor);
}

TEST(Traits, ATwinHasNoSpread) {
    const std::vector<SettingChange> changes = without_spread();
    EXPECT_FALSE(changes.empty());
    const SystemSettings settings = load_system_settings({}, changes);
    EXPECT_TRUE(fitted_keys(settings.person).empty());
    EXPECT_EQ(draw_subject(settings.person, 1, 1, 1).criterion_N, settings.person.perception.criterion_N);
}

TEST(Traits, WhatCannotActIsNotLearned) {
    OperatorParameters population;
    EXPECT_EQ(acting_traits(population, Modality::kHF).size(), 7U);
    population.behaviour.recovery = Recovery::kPush;
    EXPECT_EQ(acting_traits(population, Modality::kHF).size(), 8U);
    population.noise.sway_m = population.behaviour.push_m = 0;
    EXPECT_EQ(acting_traits(population, Modality::kHF).size(), 6U);
    for (const double score : trait_scores(population, draw_subject(population, 1, 1, 1)))
        EXPECT_TRUE(std::isfinite(score));
}

TEST(FitSummary, DrawsOfThePopulationIdentifyNothing) {
    const OperatorParameters population;
    std::vector<TraitScores> draws;
    draws.reserve(2000);
    for (std::uint32_t i = 1; i <= 2000; ++i)
        draws.push_back(trait_scores(population, draw_subject(population, 5, 1, i)));
    for (const FittedKey& key : fitted_keys(population)) {
        const KeySummary summary = summarise(key, draws);
        EXPECT_FALSE(summary.identifiable()) << key.key;
        EXPECT_NEAR(std::log(summary.high / summary.population_high), 0, 0.15 * key.spread_of_logarithm());
    }
}

}  // namespace
}  // namespace thimble
