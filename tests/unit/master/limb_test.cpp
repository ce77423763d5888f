// The limb against its equations without integrating them: statics, dissipation, friction, stability on a delayed spring.
#include "master/operator/limb.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace thimble::test {
namespace {

constexpr unsigned kSecond = 10000;  // steps
const HandleMechanics kSmooth{.friction_N = 0};
const double kSeries_N_per_m = 1 / (1 / 1000.0 + 1 / 350.0);

// Cocontraction multiplies the stiffness of both springs.
TEST(Limb, StaticPushMeetsTheTwoSpringsInSeries) {
    ASSERT_NEAR(kSeries_N_per_m, 259, 0.5);
    for (const double factor : {1.0, 2.0}) {
        Limb limb(kSmooth, HandMechanics{});
        limb.command({.stiffness_factor = factor});
        limb.advance(5 * kSecond, 5.0);
        EXPECT_NEAR(limb.position_hand_m(), -5.0 / (factor * kSeries_N_per_m), 1e-9);
        EXPECT_NEAR(limb.position_arm_m(), -5.0 / (factor * 350), 1e-9);
    }
}

TEST(Limb, ReleasedFromADisplacementItComesToRestAtTheEquilibrium) {
    Limb limb(kSmooth, HandMechanics{});
    limb.command({.equilibrium_m = 0.005});
    double highest_m = 0;
    for (unsigned i = 0; i < 3 * kSecond; ++i) {
        limb.advance(1, 0);
        highest_m = std::max(highest_m, limb.position_hand_m());
    }
    EXPECT_GT(highest_m, 0.0052);  // damping ratio 0.4: it overshoots
    EXPECT_LT(highest_m, 0.0070);
    EXPECT_NEAR(limb.position_hand_m(), 0.005, 1e-9);
}

TEST(Limb, EnergyIsNeverCreated) {
    EXPECT_TRUE(rc::check("dissipative", [] {
        HandleMechanics handle;
        handle.friction_N = *rc::gen::inRange(0, 200) * 0.01;
        Limb limb(handle, HandMechanics{});
        limb.reset(*rc::gen::inRange(200, 700), *rc::gen::inRange(500, 2500));
        limb.advance(*rc::gen::inRange<unsigned>(10, 2000), *rc::gen::inRange(-12, 13));
        double before_J = limb.energy_J();
        const double start_J = before_J;
        // A symplectic step trades a fraction w dt of the energy back and forth; over 20 ms damping wins.
        for (int i = 0; i < 50; ++i) {
            limb.advance(200, 0);
            RC_ASSERT(limb.energy_J() <= before_J + 1e-3 * start_J);
            before_J = limb.energy_J();
        }
    }));
}

TEST(Limb, FrictionHoldsASmallPushAndYieldsToALargeOne) {
    const HandleMechanics handle;
    Limb held(handle, HandMechanics{});
    held.advance(3 * kSecond, 0.3);
    EXPECT_LT(std::fabs(held.position_hand_m()), 1e-4);  // 1.2 mm without friction
    EXPECT_NEAR(held.friction_N(), -0.3, 0.02);

    Limb slipped(handle, HandMechanics{});
    slipped.advance(3 * kSecond, 5.0);
    EXPECT_NEAR(slipped.position_hand_m(), -5.0 / kSeries_N_per_m, handle.friction_N / kSeries_N_per_m);
    EXPECT_LT(slipped.position_hand_m(), -0.015);
}

TEST(Limb, FrictionRemembersWhereThePushCameFrom) {
    Limb from_below(HandleMechanics{}, HandMechanics{}), from_above(HandleMechanics{}, HandMechanics{});
    for (int step = 0; step <= 100; ++step) {
        from_below.advance(1000, 0.02 * step);
        from_above.advance(1000, 4 - 0.02 * step);
    }
    from_below.advance(kSecond, 2);
    from_above.advance(kSecond, 2);
    EXPECT_GT(from_below.position_hand_m() - from_above.position_hand_m(), 1.0 / kSeries_N_per_m / 2);
}

TEST(Limb, FrictionNeverExceedsItsLimitAtAnySpeed) {
    Limb limb(HandleMechanics{}, HandMechanics{});
    double fastest_m_per_s = 0;
    for (unsigned i = 0; i < kSecond; ++i) {
        limb.advance(1, i / 500 % 2 == 0 ? 300 : -300);
        fastest_m_per_s = std::max(fastest_m_per_s, std::fabs(limb.velocity_hand_m_per_s()));
        ASSERT_LE(std::fabs(limb.friction_N()), HandleMechanics{}.friction_N);
    }
    EXPECT_GT(fastest_m_per_s, 1.0);
}

TEST(Limb, LearnedFeedForwardCarriesTheHandThroughFriction) {
    Limb limb(HandleMechanics{}, HandMechanics{});
    double equilibrium_m = 0;
    for (int ms = 0; ms < 4000; ++ms) {
        equilibrium_m += 5e-6;
        limb.command({.equilibrium_m = equilibrium_m, .velocity_m_per_s = 0.005});
        limb.advance(10, 0);
    }
    // Without it the arm trails by F_c / k_a = 1.4 mm and the hand by another 0.5 mm.
    EXPECT_NEAR(limb.position_arm_m(), equilibrium_m, 5e-5);
    EXPECT_NEAR(limb.velocity_hand_m_per_s(), 0.005, 1e-5);
}

TEST(Limb, CuttingTheStepsDifferentlyGivesTheSameBits) {
    EXPECT_TRUE(rc::check("cuts", [] {
        Limb whole(HandleMechanics{}, HandMechanics{}), cut(HandleMechanics{}, HandMechanics{});
        unsigned total = 0;
        for (const auto steps : *rc::gen::container<std::vector<unsigned>>(rc::gen::inRange(0U, 30U))) {
            cut.advance(steps, 3);
            total += steps;
        }
        whole.advance(total, 3);
        RC_ASSERT(whole.position_hand_m() == cut.position_hand_m());
        RC_ASSERT(whole.velocity_hand_m_per_s() == cut.velocity_hand_m_per_s());
    }));
}

// Largest excursion late over early, of the hand on a spring that is sampled at 1 kHz, held, and delayed by
// so many steps of the limb.
double growth(double stiffness_N_per_m, std::size_t delay) {
    Limb limb(kSmooth, HandMechanics{});
    std::vector<double> forces_N(delay + 1);
    double early_m = 0, late_m = 0, force_N = 0;
    limb.advance(10, 1);
    for (std::size_t step = 0; step < 20 * kSecond; ++step) {
        if (step % 10 == 0) force_N = stiffness_N_per_m * limb.position_hand_m();
        forces_N[step % forces_N.size()] = force_N;
        limb.advance(1, forces_N[(step + 1) % forces_N.size()]);
        const double away_m = std::fabs(limb.position_hand_m());
        if (away_m > 1e3) return away_m;
        if (step >= kSecond && step < 2 * kSecond) early_m = std::max(early_m, away_m);
        if (step >= 19 * kSecond) late_m = std::max(late_m, away_m);
    }
    return late_m / early_m;
}

TEST(Limb, OnADelayedSpringItTurnsUnstableWhereLinearTheorySays) {
    // tau_c = min over |K G(jw)| = 1 of ((pi + arg G) mod 2 pi) / w - T / 2 for the transfer function G of
    // the limb: 1.87, 7.94, 40.4 and 54.5 ms.
    struct Bracket {
        double stiffness_N_per_m;
        std::size_t stable, unstable;  // delay in steps of 0.1 ms
    };
    for (const Bracket& bracket :
         {Bracket{9000, 18, 20}, {3000, 78, 81}, {1000, 402, 406}, {500, 542, 548}}) {
        EXPECT_LT(growth(bracket.stiffness_N_per_m, bracket.stable), 1) << bracket.stiffness_N_per_m;
        EXPECT_GT(growth(bracket.stiffness_N_per_m, bracket.unstable), 1) << bracket.stiffness_N_per_m;
    }
}

TEST(Limb, AfterAResetNobodyMovesTheArm) {
    Limb limb(kSmooth, HandMechanics{});
    limb.command({.equilibrium_m = 0.005, .stiffness_factor = 2});
    limb.advance(kSecond, 0);
    limb.reset(350, 1000);
    limb.advance(kSecond, 0);
    EXPECT_EQ(limb.position_hand_m(), 0);
}

}  // namespace
}  // namespace thimble::test
