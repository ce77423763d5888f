// The loop in continuous time: golden figures, laws that hold for every hand.
#include "stability/delayed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/error.hpp"
#include "tests/unit/stability/golden_loops.hpp"

namespace thimble {
namespace {

constexpr double kGolden = 1e-12;

DelayedLoop loop_of(const nlohmann::json& c) { return {hand_of(c), figure(c, "K"), 0}; }

TEST(DelayedLoop, GoldenFigures) {
    for (const auto& c : golden_loops("linear")) {
        const DelayedLoop loop = loop_of(c);
        const std::string tag = c.at("tag");
        const CriticalPoint point = critical_point(loop);
        expect_relative(point.delay_s, figure(c, "T_star"), kGolden, tag);
        expect_relative(point.frequency_rad_per_s, figure(c, "omega_star"), kGolden, tag);
        expect_relative(delay_independent_stiffness_N_per_m(loop.hand), figure(c, "K_delay_independent"),
                        kGolden, tag);
        const DominantRoot root = rightmost_root(loop, figure(c, "T"));
        expect_relative(root.real_per_s, figure(c, "rightmost_re"), kGolden, tag + " root");
        expect_relative(root.imaginary_rad_per_s, figure(c, "rightmost_im"), kGolden, tag + " root");
        const CriticalStiffness critical = critical_stiffness(loop.hand, figure(c, "T"));
        expect_relative(critical.stiffness_N_per_m, figure(c, "K_star_of_T"), kGolden, tag + " K*");
        expect_relative(critical.frequency_rad_per_s, figure(c, "omega_at_K_star"), kGolden, tag + " K*");
    }
}

TEST(DelayedLoop, CrossingsAndUnstableRoots) {
    for (const auto& c : golden_loops("linear")) {
        const DelayedLoop loop = loop_of(c);
        const std::string tag = c.at("tag");
        EXPECT_EQ(unstable_roots(loop, figure(c, "T")), c.at("n_unstable_at_T").get<int>()) << tag;
        const auto& expected = c.at("all_crossings_T_le_4T");
        const double longest_s = 4 * std::max(figure(c, "T"), figure(c, "T_star"));
        const auto found = crossings(loop, longest_s, 1000);
        ASSERT_GE(found.size(), expected.size()) << tag;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            expect_relative(found[i].delay_s, figure(expected[i], "T"), kGolden, tag);
            expect_relative(found[i].frequency_rad_per_s, figure(expected[i], "omega"), kGolden, tag);
            EXPECT_EQ(found[i].direction, expected[i].at("dir").get<int>()) << tag;
            EXPECT_EQ(found[i].unstable_roots_after, expected[i].at("n_unstable_after").get<int>()) << tag;
        }
    }
}

TEST(DelayedLoop, ViscosityBeforeTheFixtureArrivesLateToo) {
    for (const auto& c : golden_loops("tissue")) {
        const CriticalPoint point = critical_point({hand_of(c), figure(c, "K"), figure(c, "B_v")});
        expect_relative(point.delay_s, figure(c, "T_star"), kGolden, c.at("set"));
        expect_relative(point.frequency_rad_per_s, figure(c, "omega_star"), kGolden, c.at("set"));
    }
}

TEST(DelayedLoop, PerceptualLoop) {
    for (const auto& c : golden_loops("perceptual_loop")) {
        const PerceptualLimit limit = perceptual_limit(hand_of(c), figure(c, "tau"));
        expect_relative(limit.gain_per_s, figure(c, "L_star"), kGolden, "L*");
        expect_relative(limit.frequency_rad_per_s, figure(c, "omega"), kGolden, "w");
    }
    // Without lag s (m s^2 + b s + k) + k L: Routh says L* = b / m.
    expect_relative(perceptual_limit({1, 20, 500}, 0).gain_per_s, 20, kGolden, "without lag");
}

// Below the undelayed stiffness, loops become stable again with more delay.
TEST(DelayedLoop, StableAgainWithMoreDelay) {
    const DelayedLoop loop{{1, 2, 500}, 200, 0};
    const auto windows = stable_delays(loop, 100);
    ASSERT_GE(windows.size(), 2U);
    for (std::size_t i = 0; i < windows.size(); ++i) {
        EXPECT_EQ(unstable_roots(loop, (windows[i].from_s + windows[i].to_s) / 2), 0);
        EXPECT_LT(rightmost_root(loop, (windows[i].from_s + windows[i].to_s) / 2).real_per_s, 0);
        EXPECT_EQ(unstable_roots(loop, windows[i].to_s * 1.001), 2);
        EXPECT_GT(rightmost_root(loop, windows[i].to_s * 1.001).real_per_s, 0);
    }
    EXPECT_GT(unstable_roots(loop, windows.back().to_s * 3), 0);
    const auto any = stable_delays({{1, 20, 500}, 399.9, 0}, 100);
    ASSERT_EQ(any.size(), 1U);
    EXPECT_TRUE(std::isinf(any.front().to_s));
}

TEST(DelayedLoop, WithoutDampingTheLeastDelayIsTooMuch) {
    const DelayedLoop loop{{1, 0, 500}, 200, 0};
    EXPECT_EQ(critical_point(loop).delay_s, 0);
    EXPECT_EQ(unstable_roots(loop, 0), 0);
    EXPECT_EQ(rightmost_root(loop, 0).real_per_s, 0);
    EXPECT_EQ(unstable_roots(loop, 1e-6), 2);
    EXPECT_GT(rightmost_root(loop, 1e-6).real_per_s, 0);
    // The delay 0 alone is no window; the first one lies between half a turn of the lower crossing and a whole one of the upper.
    const auto windows = stable_delays(loop, 1);
    ASSERT_EQ(windows.size(), 1U);
    EXPECT_NEAR(windows.front().from_s, std::numbers::pi / std::sqrt(300.0), 1e-12);
    EXPECT_NEAR(windows.front().to_s, 2 * std::numbers::pi / std::sqrt(700.0), 1e-12);
    // Between one and two half turns of the hand's resonance the force brakes.
    const double half_turn_s = std::numbers::pi / std::sqrt(500.0);
    EXPECT_EQ(critical_stiffness(loop.hand, 0.5 * half_turn_s).stiffness_N_per_m, 0);
    const double braked = critical_stiffness(loop.hand, 1.5 * half_turn_s).stiffness_N_per_m;
    EXPECT_GT(braked, 100);
    EXPECT_EQ(unstable_roots({loop.hand, braked * 0.999, 0}, 1.5 * half_turn_s), 0);
    EXPECT_EQ(unstable_roots({loop.hand, braked * 1.001, 0}, 1.5 * half_turn_s), 2);
}

// From b^2 = 2 m k on a contact no stiffer than the hand is stable at any delay.
TEST(DelayedLoop, AWellDampedHandHoldsItsOwnStiffnessAtAnyDelay) {
    EXPECT_EQ(delay_independent_stiffness_N_per_m({1, 40, 500}), 500);
    EXPECT_NEAR(delay_independent_stiffness_N_per_m({1, 20, 500}), 400, 1e-9);
    EXPECT_EQ(unstable_roots({{1, 40, 500}, 499, 0}, 0.1), 0);
}

TEST(DelayedLoop, RefusesWhatIsNoLoop) {
    const std::vector<DelayedLoop> bad{{{0, 1, 1}, 1, 0},  {{-1, 1, 1}, 1, 0}, {{1, -1, 1}, 1, 0},
                                       {{1, 1, -1}, 1, 0}, {{1, 1, 1}, 0, 0},  {{1, 1, 1}, std::nan(""), 0},
                                       {{1, 1, 1}, 1, -1}};
    for (const DelayedLoop& loop : bad) EXPECT_THROW(critical_point(loop), Error);
    EXPECT_THROW(unstable_roots({{1, 1, 1}, 1, 0}, -1), Error);
    EXPECT_THROW(rightmost_root({{1, 1, 1}, 1, 0}, std::nan("")), Error);
}

// --- laws ---

double decades(double low, double high) {
    const int steps = 1 << 20;
    return low * std::pow(high / low, *rc::gen::inRange(0, steps) / static_cast<double>(steps));
}

DelayedLoop any_loop() {
    return {{decades(1e-2, 1e2), decades(1e-2, 1e2), decades(1e0, 1e4)}, decades(1, 1e7), 0};
}

RC_GTEST_PROP(DelayedLoop, TheCriticalPointIsARoot, ()) {
    const DelayedLoop loop = any_loop();
    const CriticalPoint point = critical_point(loop);
    RC_PRE(std::isfinite(point.delay_s));
    const double w = point.frequency_rad_per_s, K = loop.stiffness_N_per_m, b = loop.hand.damping_Ns_per_m;
    RC_ASSERT(std::abs(std::sin(w * point.delay_s) - b * w / K) < 1e-9);
    RC_ASSERT(point.delay_s >= b / K * (1 - 1e-12));
    // Unless another branch comes first, that K is the critical one of this delay.
    const double least = critical_stiffness(loop.hand, point.delay_s).stiffness_N_per_m;
    RC_ASSERT(std::abs(least / K - 1) < 1e-9);
}

RC_GTEST_PROP(DelayedLoop, AboveTheCriticalStiffnessItIsUnstable, ()) {
    const HeldMass hand = any_loop().hand;
    const double delay_s = decades(1e-4, 1);
    const double critical = critical_stiffness(hand, delay_s).stiffness_N_per_m;
    RC_ASSERT(critical >= hand.damping_Ns_per_m / delay_s * (1 - 1e-12));
    RC_ASSERT(unstable_roots({hand, critical * (1 - 1e-9), 0}, delay_s) == 0);
    RC_ASSERT(unstable_roots({hand, critical * (1 + 1e-9), 0}, delay_s) == 2);
}

}  // namespace
}  // namespace thimble
