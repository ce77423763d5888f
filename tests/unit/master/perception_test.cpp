// The perception of the fixture and of its loss, and the time of a decision.
#include "master/operator/perception.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/master/operator_test_tools.hpp"

namespace thimble::test {
namespace {

Perception calm(Modality modality, double criterion_N = 2) {
    return {calm_parameters().perception, Subject{.criterion_N = criterion_N}, task_of(modality)};
}

TEST(Criterion, IsCappedByTheRangeOfTheDisplayInUse) {
    struct Case {
        Modality modality;
        double own_N, used_N;
    };
    for (const Case& c : {Case{Modality::kHF, 5, 5},
                          {Modality::kVF, 5, 5},
                          {Modality::kCF, 5, 1.35},
                          {Modality::kCCF, 5, 1.35},
                          {Modality::kHF, 50, 10.8},
                          {Modality::kCF, 1, 1}})
        EXPECT_DOUBLE_EQ(calm(c.modality, c.own_N).criterion_N(), c.used_N);
}

TEST(Perception, EachModalityHasItsOwnStimulus) {
    const Percept percept{.force_N = 1.0, .bar_N = 5.0};
    EXPECT_EQ(calm(Modality::kHF).sense(3.0, {.bar_N = 5.0}).signal_N, 3.0);
    EXPECT_EQ(calm(Modality::kHF).sense(3.0, percept).signal_N, 4.0)
        << "hand and skin, where both get a share";
    EXPECT_EQ(calm(Modality::kCF).sense(3.0, percept).signal_N, 1.0);
    EXPECT_EQ(calm(Modality::kCCF).sense(3.0, percept).signal_N, 1.0);
    EXPECT_EQ(calm(Modality::kVF).sense(3.0, percept).signal_N, 5.0);
}

TEST(Perception, TheFixtureIsFeltAboveTheCriterion) {
    Perception perception = calm(Modality::kHF);
    EXPECT_FALSE(perception.sense(2.0, {}).fixture_felt);
    EXPECT_TRUE(perception.sense(2.001, {}).fixture_felt);
    EXPECT_FALSE(perception.sense(-12.0, {}).fixture_felt);
}

TEST(Perception, ContactIsLostAfterMoreThanTwentyMilliseconds) {
    Perception perception = calm(Modality::kHF);
    perception.sense(3, {});
    for (int ms = 0; ms < 20; ++ms) EXPECT_FALSE(perception.sense(0.05, {}).contact_lost) << ms;
    EXPECT_TRUE(perception.sense(0.05, {}).contact_lost);
    EXPECT_FALSE(perception.sense(0.1, {}).contact_lost);
    EXPECT_FALSE(perception.sense(0, {}).contact_lost);
}

TEST(Perception, NoiseIsTheWeberFractionOfTheStimulus) {
    for (const auto& [modality, weber] :
         {std::pair{Modality::kHF, 0.08}, std::pair{Modality::kCF, 0.16}, std::pair{Modality::kVF, 0.05}}) {
        Perception perception(PerceptionParameters{}, Subject{.criterion_N = 2}, task_of(modality));
        double sum = 0;
        constexpr int kTicks = 1'000'000;
        const double skin_N = modality == Modality::kHF ? 0 : 4;  // the hand feels the handle
        for (int i = 0; i < kTicks; ++i) {
            const double error = perception.sense(4, {.force_N = skin_N, .bar_N = 4}).signal_N / 4 - 1;
            sum += error * error;
        }
        EXPECT_NEAR(std::sqrt(sum / kTicks) / weber, 1, 0.05);
    }
}

TEST(Reaction, MediansArePublishedOnesTimesTheSubject) {
    const Subject subject{.reaction_factor = 2, .reaction_modality_factor = {1, 1, 1.5, 1}};
    const auto reaction = [&](Modality modality) {
        return ReactionTimes(calm_parameters().reaction, subject, task_of(modality));
    };
    EXPECT_EQ(reaction(Modality::kHF).to_fixture(), 230);
    EXPECT_EQ(reaction(Modality::kCF).to_fixture(), 260);
    EXPECT_EQ(reaction(Modality::kCCF).to_fixture(), 533);  // (155 + 2.6 + 20) x 2 x 1.5
    EXPECT_EQ(reaction(Modality::kVF).to_fixture(), 480);
    EXPECT_EQ(reaction(Modality::kHF).to_touch(), 480);
    EXPECT_EQ(reaction(Modality::kCCF).to_beep(), 294);
}

TEST(Reaction, EachDecisionIsDrawnAnewWithTheGivenMeanAndVariation) {
    ReactionTimes reaction(ReactionParameters{}, Subject{}, task_of(Modality::kVF));
    double sum = 0, squares = 0;
    constexpr int kDecisions = 50000;
    for (int i = 0; i < kDecisions; ++i) {
        const auto ticks = static_cast<double>(reaction.to_fixture());
        sum += ticks, squares += ticks * ticks;
    }
    const double mean = sum / kDecisions;
    EXPECT_NEAR(mean, 240, 1);
    EXPECT_NEAR(std::sqrt(squares / kDecisions - mean * mean) / mean, 0.18, 0.004);
}

}  // namespace
}  // namespace thimble::test
