// Dry friction in the running loop, and the press that ends its limit cycle, against what is predicted.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "stability/hand_motion.hpp"
#include "stability/limit_cycle.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {
namespace {

// The greatest |p| of the half swing that ends now; nothing if the loop sticks.
std::optional<double> next_swing_m(LoopSimulator& run, double step_s) {
    const bool positive = run.position_m() > 0;
    double most_m = std::abs(run.position_m());
    for (int i = 0; i < 2 / step_s; ++i) {
        run.step();
        if ((run.position_m() > 0) != positive) return most_m;
        most_m = std::max(most_m, std::abs(run.position_m()));
    }
    return std::nullopt;
}

struct Rubbed {
    bool grows;
    double steady_m;  // the half swing that differed least from the one before the last
};

// An unstable linear loop that rubs from a half swing of `from_m` on.
Rubbed rubbed_from(const SampledLoop& loop, double from_m, double friction_N) {
    constexpr double kFirst_m = 1e-7, kFar = 3;
    LoopConditions conditions;
    conditions.loop = loop;
    const auto settled_m = [&](LoopSimulator& run) {
        double swing_m = 0;
        for (int i = 0; i < 30; ++i) swing_m = next_swing_m(run, loop.step_s).value();
        return swing_m;
    };
    LoopSimulator free(conditions, kFirst_m, 0);
    LoopSimulator run(conditions, kFirst_m * from_m / settled_m(free), 0);
    EXPECT_NEAR(settled_m(run), from_m, 1e-9 * from_m);
    run.rub(friction_N);
    Rubbed result{false, 0};
    for (double least = 1, before_m = 0, last_m = from_m;;) {
        const auto swing_m = next_swing_m(run, loop.step_s);
        result.grows = swing_m && *swing_m > kFar * from_m;
        if (!swing_m || result.grows || *swing_m < from_m / kFar) return result;
        if (before_m > 0 && std::abs(std::log(*swing_m / before_m)) < least) {
            least = std::abs(std::log(*swing_m / before_m));
            result.steady_m = *swing_m;
        }
        before_m = std::exchange(last_m, *swing_m);
    }
}

// The amplitude that neither dies out nor grows: friction begins ever closer to it.
double measured_threshold_m(const SampledLoop& loop, double friction_N, double forecast_m) {
    double low_m = forecast_m / 3, high_m = 3 * forecast_m;
    EXPECT_FALSE(rubbed_from(loop, low_m, friction_N).grows);
    EXPECT_TRUE(rubbed_from(loop, high_m, friction_N).grows);
    while (high_m / low_m > 1 + 1e-7) {
        const double middle_m = std::sqrt(low_m * high_m);
        (rubbed_from(loop, middle_m, friction_N).grows ? high_m : low_m) = middle_m;
    }
    return rubbed_from(loop, high_m, friction_N).steady_m;
}

TEST(PressFold, IsInfiniteForACycleWithoutEnd) {
    const auto fold_N = press_fold_N({{0.25, 0.05, 500}, 9000, 0.05, 12, 0});
    ASSERT_TRUE(fold_N);
    EXPECT_TRUE(std::isinf(*fold_N)) << *fold_N;
}

// The greatest press with which the loop at the wall still cycles, pressed harder and harder by rise_N_per_s from half of the limit.
double measured_press_fold_N(const LoopConditions& conditions, double rise_N_per_s) {
    constexpr double kSwinging_s = 3, kKept_s = 1;
    LoopConditions start = conditions;
    start.press_N = conditions.force_limit_N / 2;
    LoopSimulator run(start, -5e-3, 0.1);
    const double step_s = conditions.loop.step_s;
    const auto swinging = static_cast<long>(kSwinging_s / step_s), kept = static_cast<long>(kKept_s / step_s);
    double press_N = start.press_N, cycled_N = press_N;
    // The strip is where the force changes; a cycle leaves it at one side or the other again and again.
    const double strip_m = conditions.force_limit_N / conditions.loop.stiffness_N_per_m;
    long since = 0;
    bool beyond = false;
    for (long i = 0; since < kept; ++i, ++since) {
        if (i >= swinging) run.press(press_N += rise_N_per_s * step_s);
        run.step();
        const bool now = run.sampled_m() > strip_m;
        if (now == beyond) continue;
        beyond = now;
        cycled_N = press_N;
        since = 0;
    }
    return cycled_N;
}

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
        const double measured_m = measured_threshold_m(loop, 0.05, forecast_m);
        EXPECT_GT(measured_m, 0.90 * forecast_m) << excess;
        EXPECT_LT(measured_m, 1.17 * forecast_m) << excess;
    }
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
