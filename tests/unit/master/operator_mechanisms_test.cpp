// Each mechanism of the operator that is off by default, alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "master/devices/simulated_handle.hpp"
#include "tests/unit/master/operator_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

TEST(StretchReflex, AnswersOneLatencyLaterForOneWindow) {
    StretchReflex reflex({.gain = 0.5, .latency_s = 0.060, .window_s = 0.040});
    for (int ms = 0; ms < 300; ++ms) {
        const double stretch_m = ms >= 10 ? 0.001 : 0;
        const double answer_m = reflex.answer(0.020 + stretch_m, 0.020);
        EXPECT_DOUBLE_EQ(answer_m, ms >= 70 && ms < 110 ? -0.0005 : 0) << ms;
    }
    StretchReflex off({});
    EXPECT_EQ(off.answer(0.020, 0.010), 0);
}

// The hand at rest, pushed out by the handle for 2 s and let go: where it had come to rest, and how far it swings beyond zero.
struct Pushed {
    double rest_m = 0, swing_m = 0;
};
Pushed pushed(const OperatorParameters& parameters) {
    constexpr double kPush_N = 2;
    SimulatedHandle handle(HandleSettings{.mechanics = {.friction_N = 0}}, parameters);
    handle.start_trial({}, task_of(Modality::kVF));
    Pushed result;
    for (int ms = 0; ms < 4000; ++ms) {
        handle.command_force(at(milliseconds{ms}), ms < 2000 ? kPush_N : 0);
        if (ms == 2000) result.rest_m = -handle.position_hand_m();
        if (ms > 2000) result.swing_m = std::max(result.swing_m, handle.position_hand_m());
    }
    return result;
}

// An operator who does not approach, so that only the body moves.
OperatorParameters resting() {
    OperatorParameters parameters = calm_parameters();
    parameters.behaviour.speed_free_needle_m_per_s = 1e-9;
    return parameters;
}

TEST(Load, MakesArmAndGripStifferAndMoreDamped) {
    OperatorParameters stiffer = resting(), damped = resting();
    stiffer.hand.load_stiffness_per_N = 0.25;
    damped.hand.load_damping_per_N = 0.5;
    const Pushed before = pushed(resting());
    const double soft_m = 2.0 / 350 + 2.0 / 1000;
    EXPECT_NEAR(before.rest_m, soft_m, 3e-5);
    // In equilibrium F = k (1 + a k d) d, with k d = 2 N where the relaxed arm would be: the root of that equation.
    const double load_N = (-1 + std::sqrt(1 + 4 * 0.25 * 2.0)) / (2 * 0.25);
    EXPECT_NEAR(pushed(stiffer).rest_m, (2.0 / 350 + 2.0 / 1000) / (1 + 0.25 * load_N), 3e-5);
    EXPECT_NEAR(pushed(damped).rest_m, soft_m, 3e-5) << "a damper holds nothing";
    EXPECT_LT(pushed(damped).swing_m, 0.7 * before.swing_m);
    LoadedMuscles muscles(stiffer.hand);
    double load = 0;
    for (int ms = 0; ms < 50; ++ms) load = muscles.follow(2);
    EXPECT_NEAR(load, 2 * (1 - std::exp(-1)), 1e-9) << "one lag";
}

TEST(StretchReflex, AnswersASwingAndNoSteadyPush) {
    OperatorParameters quick = resting();
    quick.reflex.gain = 0.5;
    const Pushed before = pushed(resting()), with = pushed(quick);
    EXPECT_NEAR(with.rest_m, before.rest_m, 3e-5);
    EXPECT_GT(std::fabs(with.swing_m - before.swing_m), 0.1 * before.swing_m);
}

TEST(SwitchCosts, AreThoseOfSenseAndHand) {
    const ReactionParameters costs{.switch_modality_s = 0.05, .switch_hand_s = 0.02};
    // From HF, CF, CCF, VF (rows) to the same.
    constexpr std::array<std::array<double, 4>, 4> kExpected{
        {{0, 0.05, 0.07, 0.05}, {0.05, 0, 0.02, 0.05}, {0.07, 0.02, 0, 0.05}, {0.05, 0.05, 0.07, 0}}};
    for (std::size_t from = 0; from < 4; ++from) {
        for (std::size_t to = 0; to < 4; ++to)
            EXPECT_DOUBLE_EQ(switch_cost_s(costs, kModalities[from], kModalities[to]), kExpected[from][to])
                << from << to;
    }
}

TEST(SwitchCosts, ArePaidOnceAndNeverInTheFirstTrial) {
    ReactionParameters costs = calm_parameters().reaction;
    costs.switch_modality_s = 0.05;
    OperatorTask task = task_of(Modality::kHF);
    const auto first_ms = [&] {
        Subject subject;
        ReactionTimes reactions(costs, subject, task);
        const auto first = reactions.to_fixture();
        EXPECT_EQ(reactions.to_fixture(), 115);
        return first;
    };
    EXPECT_EQ(first_ms(), 115);
    int switched = 0;
    for (task.trial = 2; task.trial <= 401; ++task.trial) switched += first_ms() == 165;
    EXPECT_NEAR(switched / 400.0, 0.75, 0.08) << "three of four trials before are of another sense";
}

// Speed of the second insertion, after one loss, and how stiff the limb is then.
std::pair<double, double> after_a_loss(double exponent, std::uint32_t trial) {
    OperatorParameters parameters = calm_parameters();
    parameters.behaviour.learning_exponent = exponent;
    OperatorTask task = task_of(Modality::kHF);
    task.trial = trial;
    Behaviour behaviour(parameters, draw_subject(parameters, 7, 1, 1), task);
    const auto spend = [&](int ticks, const Sensation& sensation) {
        for (int i = 0; i < ticks; ++i) behaviour.step(sensation, true, false, 0);
    };
    spend(3000, kNothing);
    spend(1500, kFixture);
    spend(2000, kNothing);
    return {behaviour.intention().velocity_m_per_s, behaviour.intention().stiffness_factor};
}

TEST(Learning, SlowsAndStiffensMoreFromTrialToTrial) {
    EXPECT_EQ(after_a_loss(0, 20), after_a_loss(0, 1));
    const auto novice = after_a_loss(0.3, 1), practised = after_a_loss(0.3, 8);
    EXPECT_EQ(novice, after_a_loss(0, 1)) << "the first trial has nothing learned";
    const double learned = std::pow(8, 0.3);
    EXPECT_NEAR(practised.first, novice.first / learned, 1e-6);
    EXPECT_NEAR(practised.second - 1, (novice.second - 1) * learned, 1e-9);
}

double stopped_at_m(Modality modality, double press_N) {
    OperatorParameters parameters = calm_parameters();
    parameters.behaviour.press_N = press_N;
    Behaviour behaviour(parameters, draw_subject(parameters, 7, 1, 1), task_of(modality));
    for (int i = 0; i < 3000; ++i) behaviour.step(kNothing, true, false, 0);
    for (int i = 0; i < 2000; ++i) behaviour.step(kFixture, true, false, 0);
    return behaviour.intention().position_m;
}

TEST(Press, LeansOnTheFixtureInHandleFeedbackOnly) {
    EXPECT_NEAR(stopped_at_m(Modality::kHF, 1.4) - stopped_at_m(Modality::kHF, 0), 1.4 / 350, 1e-7);
    EXPECT_EQ(stopped_at_m(Modality::kCF, 1.4), stopped_at_m(Modality::kCF, 0));
}

TEST(Experience, DividesEachCohortInHalves) {
    OperatorParameters parameters, equal;
    parameters.spread.experience = 0.4;
    parameters.behaviour.press_N = equal.behaviour.press_N = 1;
    for (std::uint32_t subject = 1; subject <= 16; ++subject) {
        const Subject drawn = draw_subject(parameters, 11, 1, subject),
                      same = draw_subject(equal, 11, 1, subject);
        const double factor = std::exp(subject % 2 == 1 ? -0.2 : 0.2);
        EXPECT_NEAR(drawn.reaction_factor / same.reaction_factor, factor, 1e-12);
        EXPECT_NEAR(drawn.criterion_N / same.criterion_N, factor, 1e-12);
        EXPECT_NEAR(drawn.press_N / same.press_N, factor, 1e-12);
        EXPECT_EQ(drawn.sway_m, same.sway_m);
    }
}

// Root mean square of the needle about its mean in holds of 4.5 s with CF, as metrics.hpp counts it; in mm.
double hold_mm(double friction_N, double sway_m) {
    OperatorParameters parameters;
    parameters.spread = calm_parameters().spread;
    parameters.noise.sway_m = sway_m;
    SimulatedHandle handle(HandleSettings{.mechanics = {.friction_N = friction_N}}, parameters);
    handle.start_trial({}, task_of(Modality::kCF));
    constexpr int kBegin_ms = 3000, kHold_ms = 4500, kHolds = 40;
    double square_mm2 = 0;
    std::vector<double> needle_mm;
    for (int ms = 0; ms < kBegin_ms + kHolds * kHold_ms; ++ms) {
        handle.perceive(at(milliseconds{ms}), {.force_N = ms > 1500 ? 3.0 : 0.0, .touching_shown = true});
        if (ms >= kBegin_ms) needle_mm.push_back(3000 * handle.position_hand_m());
        if (needle_mm.size() < kHold_ms) continue;
        double mean = 0;
        for (const double at_mm : needle_mm) mean += at_mm / kHold_ms;
        for (const double at_mm : needle_mm) square_mm2 += (at_mm - mean) * (at_mm - mean) / kHold_ms;
        needle_mm.clear();
    }
    return std::sqrt(square_mm2 / kHolds);
}

TEST(Steadiness, IsThatOfPeopleWhereFrictionDoesNotHoldTheHand) {
    EXPECT_LT(hold_mm(0.65, 2.5e-4), 0.05) << "frozen: the defaults";
    const double moving_mm = hold_mm(0.1, 4e-4);
    EXPECT_GE(moving_mm, 0.5);
    EXPECT_LE(moving_mm, 0.76);
}

}  // namespace
}  // namespace thimble::test
