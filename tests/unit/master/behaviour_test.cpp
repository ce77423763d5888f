// Every arrow of the state machine, with a subject whose draws are all medians.
#include "master/operator/behaviour.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/master/operator_test_tools.hpp"

namespace thimble::test {
namespace {

class Actor {
  public:
    explicit Actor(Modality modality, const OperatorParameters& parameters = calm_parameters())
        : behaviour_(parameters, draw_subject(parameters, 7, 1, 1), task_of(modality)) {}

    // Ticks until the phase is `phase`, or -1.
    int until(BehaviourPhase phase, const Sensation& sensation, int limit = 20000) {
        for (int ticks = 0; ticks <= limit; ++ticks) {
            if (behaviour_.phase() == phase) return ticks;
            behaviour_.step(sensation, touching, beep, arm_m);
        }
        return -1;
    }
    void spend(int ticks, const Sensation& sensation) {
        for (int i = 0; i < ticks; ++i) behaviour_.step(sensation, touching, beep, arm_m);
    }
    // In the tissue, at the speed of the insertion.
    void insert() {
        touching = true;
        spend(3000, kNothing);
    }
    // Up to a quiet hold on the fixture.
    void hold() {
        touching = true;
        until(BehaviourPhase::kInsert, kNothing);
        spend(2000, kNothing);
        until(BehaviourPhase::kHold, kFixture);
        spend(1000, kFixture);
    }
    const Behaviour& behaviour() const { return behaviour_; }
    double position_m() const { return behaviour_.intention().position_m; }
    double velocity_m_per_s() const { return behaviour_.intention().velocity_m_per_s; }

    bool touching = false, beep = false;
    double arm_m = 0;

  private:
    Behaviour behaviour_;
};

TEST(Behaviour, ApproachesAtFreeSpeedUntilTheTouchIsSeen) {
    Actor actor(Modality::kHF);
    actor.spend(1000, kFixture);  // before the tissue is touched nothing is the fixture
    EXPECT_EQ(actor.behaviour().phase(), BehaviourPhase::kApproach);
    EXPECT_NEAR(actor.velocity_m_per_s(), 0.020, 1e-5);
    actor.touching = true;
    EXPECT_EQ(actor.until(BehaviourPhase::kInsert, kNothing), 241);
}

TEST(Behaviour, TheApproachIsTheSameInEveryModality) {
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        Actor actor(modality), reference(Modality::kHF);
        for (Actor* each : {&actor, &reference}) {
            each->spend(500, kNothing);
            each->touching = true;
            each->spend(1500, kNothing);
        }
        EXPECT_EQ(actor.position_m(), reference.position_m());
    }
}

TEST(Behaviour, StopsOneReactionTimeAfterTheFixtureIsFelt) {
    for (const auto& [modality, ticks] : {std::pair{Modality::kHF, 115}, std::pair{Modality::kCF, 130},
                                          std::pair{Modality::kCCF, 178}, std::pair{Modality::kVF, 240}}) {
        Actor actor(modality);
        actor.insert();
        EXPECT_EQ(actor.behaviour().phase(), BehaviourPhase::kInsert);
        EXPECT_NEAR(actor.velocity_m_per_s(), 0.005, 1e-6);
        actor.spend(1, kFixture);  // a moment is enough: the decision is made
        EXPECT_EQ(actor.until(BehaviourPhase::kBrake, kNothing), ticks) << to_string(modality);
    }
}

TEST(Behaviour, BrakesAlongARaisedCosine) {
    Actor actor(Modality::kHF);
    actor.insert();
    actor.until(BehaviourPhase::kBrake, kFixture);
    const double from_m = actor.position_m() - actor.velocity_m_per_s() * 1e-3;  // the first tick has moved
    EXPECT_EQ(actor.until(BehaviourPhase::kHold, kFixture), 150);
    EXPECT_NEAR(actor.position_m() - from_m, 0.005 * 0.150 / 2, 1e-8);
    EXPECT_EQ(actor.velocity_m_per_s(), 0);
    const double there_m = actor.position_m();
    actor.spend(10000, kFixture);
    EXPECT_EQ(actor.position_m(), there_m) << "in contact it holds still";
    EXPECT_EQ(actor.behaviour().recoveries(), 0U);
}

OperatorParameters pushing_parameters() {
    OperatorParameters parameters = calm_parameters();
    parameters.behaviour.recovery = Recovery::kPush;
    return parameters;
}

TEST(Behaviour, RelaxesToWhereTheArmIsAndApproachesAgainSlower) {
    Actor actor(Modality::kVF);
    actor.hold();
    for (const double slowing : {0.6, 0.36}) {
        actor.arm_m = actor.position_m() - 0.002;
        const double thrown_to_m = actor.arm_m;
        ASSERT_EQ(actor.until(BehaviourPhase::kRelax, kNothing), 241);
        EXPECT_EQ(actor.until(BehaviourPhase::kInsert, kNothing), 250);
        EXPECT_NEAR(actor.position_m(), thrown_to_m, 1e-5);  // the first tick of the insertion is in it
        actor.spend(1500, kNothing);
        EXPECT_NEAR(actor.velocity_m_per_s(), slowing * 0.005, 1e-6);
        ASSERT_GT(actor.until(BehaviourPhase::kHold, kFixture), 0);
        actor.spend(1000, kFixture);
    }
    EXPECT_EQ(actor.behaviour().recoveries(), 2U);
    EXPECT_EQ(actor.behaviour().contact_losses(), 2U);
}

TEST(Behaviour, SlowsDownNoFurtherThanItsSlowest) {
    Actor actor(Modality::kHF);
    actor.hold();
    for (int loss = 0; loss < 8; ++loss) {
        actor.until(BehaviourPhase::kInsert, kNothing);
        actor.until(BehaviourPhase::kHold, kFixture);
    }
    actor.until(BehaviourPhase::kInsert, kNothing);
    actor.spend(2000, kNothing);
    EXPECT_NEAR(actor.velocity_m_per_s(), 0.1 * 0.005, 1e-7);
}

TEST(Behaviour, AnArmThatWasThrownForwardIsNoReasonToPush) {
    Actor actor(Modality::kHF);
    actor.hold();
    const double there_m = actor.position_m();
    actor.arm_m = there_m + 0.002;
    actor.until(BehaviourPhase::kRelax, kNothing);
    actor.spend(200, kNothing);
    EXPECT_EQ(actor.position_m(), there_m);
}

TEST(Behaviour, PushesHarderEachTimeContactBreaks) {
    Actor actor(Modality::kVF, pushing_parameters());
    actor.hold();
    double stride_m = 1.0e-3, from_m = actor.position_m();
    for (unsigned push = 1; push <= 3; ++push) {
        ASSERT_EQ(actor.until(BehaviourPhase::kPush, kNothing), 241);
        EXPECT_EQ(actor.until(BehaviourPhase::kHold, kFixture), 250);
        EXPECT_NEAR(actor.position_m() - from_m, stride_m, 1e-7);
        EXPECT_EQ(actor.behaviour().recoveries(), push);
        actor.spend(1000, kFixture);
        from_m = actor.position_m();
        stride_m *= 1.6;
    }
    EXPECT_EQ(actor.behaviour().contact_losses(), 3U);
}

TEST(Behaviour, DoesNotPushBeforeTheRefractoryTimeIsOver) {
    Actor actor(Modality::kHF, pushing_parameters());
    actor.insert();
    actor.until(BehaviourPhase::kHold, kFixture);
    EXPECT_EQ(actor.until(BehaviourPhase::kPush, kNothing), 250 + 115);
}

TEST(Behaviour, StiffensWithEachLossButOnlyWhoFeelsTheKicks) {
    Actor kinesthetic(Modality::kHF), cutaneous(Modality::kCF);
    for (Actor* actor : {&kinesthetic, &cutaneous}) actor->hold();
    for (int loss = 1; loss <= 6; ++loss) {
        for (Actor* actor : {&kinesthetic, &cutaneous}) {
            actor->spend(5, kNothing);
            actor->spend(5, kFixture);
        }
        EXPECT_DOUBLE_EQ(kinesthetic.behaviour().intention().stiffness_factor,
                         std::min(1 + 0.25 * loss, 2.0));
        EXPECT_EQ(cutaneous.behaviour().intention().stiffness_factor, 1);
    }
    EXPECT_EQ(kinesthetic.behaviour().contact_losses(), 6U);
}

// Felt again and lost within the reaction time to the feeling: the second insertion ends in a loss of its own.
TEST(Behaviour, ALossBeforeTheStopOfTheNextInsertionIsAnother) {
    Actor actor(Modality::kHF);
    actor.hold();
    ASSERT_GT(actor.until(BehaviourPhase::kRelax, kNothing), 0);
    ASSERT_GT(actor.until(BehaviourPhase::kInsert, kNothing), 0);
    actor.spend(500, kNothing);  // on the way there nothing is felt, and that is no loss
    EXPECT_EQ(actor.behaviour().contact_losses(), 1U);
    actor.spend(1, kFixture);
    ASSERT_GT(actor.until(BehaviourPhase::kBrake, kNothing), 0);
    actor.spend(1, kNothing);
    EXPECT_EQ(actor.behaviour().contact_losses(), 2U);
    EXPECT_DOUBLE_EQ(actor.behaviour().intention().stiffness_factor, 1.5);
}

TEST(Behaviour, WithdrawsAfterTheBeepFromAnyPhase) {
    for (const int spent : {100, 1500, 3100, 3200, 4000}) {
        Actor actor(Modality::kHF);
        actor.touching = true;
        for (int i = 0; i < spent; ++i) actor.spend(1, i < 3000 ? kNothing : kFixture);
        actor.beep = true;
        EXPECT_EQ(actor.until(BehaviourPhase::kWithdraw, kFixture), 148) << spent;
        EXPECT_GT(actor.until(BehaviourPhase::kDone, kNothing), 0);
        EXPECT_LT(actor.position_m(), 0);
        EXPECT_EQ(actor.velocity_m_per_s(), 0);
    }
    Actor relaxing(Modality::kHF);
    relaxing.hold();
    ASSERT_GT(relaxing.until(BehaviourPhase::kRelax, kNothing), 0);
    relaxing.beep = true;
    EXPECT_EQ(relaxing.until(BehaviourPhase::kWithdraw, kNothing), 148);
    EXPECT_GT(relaxing.until(BehaviourPhase::kDone, kNothing), 0);
}

TEST(Behaviour, APushMayStartBeforeTheWithdrawalAndIsOverriddenByIt) {
    Actor actor(Modality::kHF, pushing_parameters());
    actor.hold();
    const double there_m = actor.position_m();
    actor.beep = true;  // and the fixture vanishes
    ASSERT_EQ(actor.until(BehaviourPhase::kPush, kNothing), 116);
    EXPECT_EQ(actor.until(BehaviourPhase::kWithdraw, kNothing), 32);
    EXPECT_GT(actor.position_m(), there_m);
    EXPECT_GT(actor.until(BehaviourPhase::kDone, kNothing), 0);
    EXPECT_EQ(actor.behaviour().recoveries(), 1U);
}

TEST(Behaviour, WithdrawsAtItsSpeed) {
    Actor actor(Modality::kHF);
    actor.insert();
    actor.insert();
    actor.beep = true;
    actor.spend(148 + 700, kNothing);
    EXPECT_NEAR(actor.velocity_m_per_s(), -0.1 / 3, 1e-4);
}

TEST(Behaviour, SpeedVariesBetweenTrialsAndWithinOne) {
    OperatorParameters parameters = calm_parameters();
    parameters.noise.speed_noise_fraction = 0.1;
    Actor noisy(Modality::kHF, parameters);
    noisy.touching = true;
    noisy.spend(2000, kNothing);
    double sum = 0, squares = 0;
    constexpr int kTicks = 200000;
    for (int i = 0; i < kTicks; ++i) {
        noisy.spend(1, kNothing);
        sum += noisy.velocity_m_per_s(), squares += noisy.velocity_m_per_s() * noisy.velocity_m_per_s();
    }
    const double mean = sum / kTicks;
    EXPECT_NEAR(mean, 0.005, 2e-4);
    // Behind the 0.1 s lag an OU of tau 0.5 s keeps 0.5 / 0.6 of its variance.
    EXPECT_NEAR(std::sqrt(squares / kTicks - mean * mean) / mean, 0.1 * std::sqrt(0.5 / 0.6), 0.02);
}

// With such a variation every other draw is a negative speed.
TEST(Behaviour, NoDrawMakesAHandThatNeverArrives) {
    OperatorParameters parameters = calm_parameters();
    parameters.behaviour.speed_trial_variation = 10;
    for (std::uint32_t subject = 1; subject <= 8; ++subject) {
        Behaviour behaviour(parameters, draw_subject(parameters, 7, 1, subject),
                            task_of(Modality::kHF, subject));
        for (int i = 0; i < 1000; ++i) behaviour.step(kNothing, true, false, 0);
        EXPECT_GT(behaviour.intention().position_m, 0) << subject;
    }
}

}  // namespace
}  // namespace thimble::test
