// Dry friction in the running loop, and the press that ends its limit cycle, against what is predicted.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "stability/hand_motion.hpp"
#include "stability/limit_cycle.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {
namespace {

// An undamped spring that rubs loses 2 f_c / k of amplitude in each half swing and ends within f_c / k of its rest.
TEST(HandMotion, AFreeSwingLosesTheSameAmountEachTime) {
    const HeldMass hand{1, 0, 400};
    const double friction_N = 0.1, lost_m = 2 * friction_N / 400;
    for (const double step_s : {1e-4, 1e-3, 0.1, 1.0}) {
        HandMotion motion(hand, 10.3 * lost_m, 0);
        motion.rub(friction_N);
        const Propagator whole = motion.propagator(step_s);
        for (int i = 0; i < 4 / step_s; ++i) motion.advance(whole, 0);
        EXPECT_EQ(motion.velocity_m_per_s(), 0) << step_s;
        EXPECT_NEAR(motion.position_m(), 0.3 * lost_m, 1e-12) << step_s;
    }
}

TEST(HandMotion, SticksUntilTheForceIsGreaterThanFriction) {
    HandMotion motion({0.5, 5, 200}, 0, 0);
    motion.rub(0.2);
    const Propagator step = motion.propagator(1e-3);
    for (int i = 0; i < 100; ++i) motion.advance(step, i % 2 == 0 ? 0.2 : -0.2);
    EXPECT_EQ(motion.position_m(), 0);
    motion.advance(step, 0.2000001);
    EXPECT_GT(motion.position_m(), 0);
}

// However it is cut, the same motion: with and without turns inside a step, damped in every way.
TEST(HandMotion, IsTheSameInLargeAndSmallSteps) {
    for (const HeldMass& hand :
         {HeldMass{0.2, 1, 300}, HeldMass{0.2, 60, 300}, HeldMass{0.2, 15.5, 300}, HeldMass{1, 2, 0}}) {
        HandMotion coarse(hand, 1e-3, 0.4), fine(hand, 1e-3, 0.4);
        coarse.rub(0.3);
        fine.rub(0.3);
        const Propagator large = coarse.propagator(0.05), small = fine.propagator(0.05 / 64);
        for (int i = 0; i < 30; ++i) {
            const double force_N = 2 * std::sin(i);
            coarse.advance(large, force_N);
            for (int part = 0; part < 64; ++part) fine.advance(small, force_N);
            ASSERT_NEAR(coarse.position_m(), fine.position_m(), 1e-12) << hand.damping_Ns_per_m << ' ' << i;
            ASSERT_NEAR(coarse.velocity_m_per_s(), fine.velocity_m_per_s(), 1e-11)
                << hand.damping_Ns_per_m << ' ' << i;
        }
    }
}

TEST(LoopSimulator, FrictionThatIsNoneIsRefused) {
    LoopConditions conditions;
    conditions.loop = {{1, 20, 500}, 600, 0.05, 1e-3};
    conditions.friction_N = -1;
    EXPECT_THROW(LoopSimulator(conditions, 0, 0), Error);
}

// Section 2 of the study: operator D, 50 ms, 0.05 N; between 0.90 and 1.17 of the first harmonic's estimate.
TEST(LoopMeasures, FrictionStopsSwingsUpToItsThreshold) {
    const HeldMass hand{1, 20, 500};
    for (const double excess : {1.05, 1.2, 1.5}) {
        SampledLoop loop{hand, 1, 0.05, 1e-3};
        loop.stiffness_N_per_m = excess * critical_sampled_stiffness(loop).stiffness_N_per_m;
        const double forecast_m = friction_threshold_m({hand, loop.stiffness_N_per_m}, 0.0505, 0.05);
        const double measured_m = measured_friction_threshold_m(loop, 0.05);
        EXPECT_GT(measured_m, 0.90 * forecast_m) << excess;
        EXPECT_LT(measured_m, 1.17 * forecast_m) << excess;
    }
    EXPECT_THROW(measured_friction_threshold_m({hand, 300, 0.05, 1e-3}, 0.05), Error);
}

// F0_fold of the study, N, for delays of 10, 25, 50, 100 ms: the loop that runs, and the forecast.
TEST(LoopMeasures, ThePressThatEndsTheCycle) {
    struct Folds {
        HeldMass hand;
        std::array<double, 4> fold_N;
    };
    const std::array<double, 4> delays_s{0.010, 0.025, 0.050, 0.100};
    for (const Folds& f :
         {Folds{{0.15, 3, 300}, {14.7, 17.2, 17.7, 16.0}}, Folds{{0.35, 6, 400}, {13.8, 15.7, 16.9, 16.2}},
          Folds{{0.55, 6.45, 135}, {12.3, 13.0, 13.7, 14.4}}, Folds{{1, 20, 500}, {12.7, 12.9, 13.6, 13.8}},
          Folds{{2, 40, 1000}, {13.3, 13.3, 13.7, 14.1}}}) {
        for (std::size_t i = 0; i < delays_s.size(); ++i) {
            LoopConditions conditions;
            conditions.loop = {f.hand, 9000, delays_s[i], 1e-3};
            conditions.one_sided = true;
            conditions.force_limit_N = 12;
            const auto forecast_N = press_fold_N({f.hand, 9000, delays_s[i] + 5e-4, 12, 0});
            ASSERT_TRUE(forecast_N);
            EXPECT_NEAR(*forecast_N, f.fold_N[i], 0.4) << f.hand.mass_kg << ' ' << delays_s[i];
            if (i != 1) continue;  // running them all takes a second and tells no more
            // Pressed ever harder, the loop is a little behind.
            const double measured_N = measured_press_fold_N(conditions, 0.2);
            EXPECT_GT(measured_N, f.fold_N[i] - 0.2) << f.hand.mass_kg;
            EXPECT_LT(measured_N, f.fold_N[i] + 0.5) << f.hand.mass_kg;
        }
    }
}

}  // namespace
}  // namespace thimble
