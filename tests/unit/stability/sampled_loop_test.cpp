// The sampled loop: golden figures, counting against numeric winding, rules of thumb against the exact theory.
#include "stability/sampled_loop.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/error.hpp"
#include "stability/circle_count.hpp"
#include "tests/unit/stability/golden_loops.hpp"

namespace thimble {
namespace {

constexpr double kExact = 1e-12;

TEST(SampledLoop, GoldenFigures) {
    for (const auto& c : golden_loops("linear")) {
        const SampledLoop loop{hand_of(c), figure(c, "K"), figure(c, "T"), figure(c, "dt")};
        const std::string tag = c.at("tag");
        const DominantMode mode = dominant_mode(loop);
        expect_relative(mode.radius, figure(c, "rho"), kExact, tag);
        expect_relative(mode.radius * std::cos(mode.angle_rad), figure(c, "z_dom_re"), kExact, tag);
        expect_relative(mode.radius * std::sin(mode.angle_rad), std::abs(figure(c, "z_dom_im")), 1e-11, tag);
        const SampledLimit limit = critical_sampled_stiffness(loop);
        expect_relative(limit.stiffness_N_per_m, figure(c, "K_star_sampled"), 4e-12, tag);
        expect_relative(limit.angle_rad, figure(c, "theta_at_K_star"), 1e-11, tag);
        const auto steps = critical_steps(loop);
        ASSERT_TRUE(steps) << tag;
        expect_relative(steps->steps, figure(c, "d_star_real"), kExact, tag);
        expect_relative(steps->angle_rad, figure(c, "theta_star"), kExact, tag);
    }
}

TEST(SampledLoop, GainsThatStayStable) {
    for (const auto& c : golden_loops("alpha_star_1kHz")) {
        const SampledLoop loop{hand_of(c), 9000, figure(c, "T_ms") * 1e-3, 1e-3};
        expect_relative(critical_sampled_stiffness(loop).stiffness_N_per_m, figure(c, "K_star"), 1e-11,
                        c.at("set"));
        expect_relative(critical_sampled_stiffness(loop).stiffness_N_per_m / 9000, figure(c, "alpha_star"),
                        1e-11, c.at("set"));
        expect_relative(half_sample_stiffness_N_per_m(loop), figure(c, "K_star"), 0.0018, "half-sample rule");
        EXPECT_GE(figure(c, "K_star"), passive_stiffness_N_per_m(loop));
    }
}

// Delays between whole steps: continuous, and the same from both forms.
TEST(SampledLoop, FractionsOfAStep) {
    const HeldMass hand{1, 20, 500};
    const auto radius = [&](double delay_s) { return dominant_mode({hand, 3000, delay_s, 1e-3}).radius; };
    for (const double whole_s : {0.0, 0.001, 0.007}) {
        EXPECT_NEAR(radius(whole_s), radius(whole_s + 1e-9), 1e-7);
        EXPECT_NEAR(radius(whole_s + 0.001), radius(whole_s + 0.001 - 1e-9), 1e-7);
    }
    double last = 0;
    for (const double T : {0.0, 0.0003, 0.0007, 0.001, 0.0014, 0.0019, 0.002, 0.0031}) {
        EXPECT_GT(radius(T), last) << T;
        last = radius(T);
        // A hold adds half a step.
        EXPECT_NEAR(std::log(last) / 1e-3, rightmost_root({hand, 3000, 0}, T + 0.0005).real_per_s, 0.02) << T;
    }
}

TEST(SampledLoop, WhereItBecomesUnstable) {
    const SampledLoop loop{{0.35, 6, 400}, 9000, 0.0123, 1e-3};
    const double limit = critical_sampled_stiffness(loop).stiffness_N_per_m;
    const auto with = [&](double stiffness) {
        return SampledLoop{loop.hand, stiffness, loop.delay_s, loop.step_s};
    };
    EXPECT_EQ(growing_modes(with(limit * (1 - 1e-10))), 0);
    EXPECT_EQ(growing_modes(with(limit * (1 + 1e-10))), 2);
    EXPECT_NEAR(dominant_mode(with(limit)).radius, 1, 1e-12);
}

TEST(SampledLoop, HardCases) {
    // Seconds of delay: thousands of roots on each side.
    const SampledLoop far{{0.15, 3, 300}, 9000, 5, 1e-3};
    EXPECT_GT(growing_modes(far), 100);
    EXPECT_NEAR(dominant_mode(far).growth_per_s, rightmost_root({far.hand, 9000, 0}, 5.0005).real_per_s,
                1e-3);
    // The fixture of 1e6 N/m at 1 ms and a hand of no damping.
    EXPECT_GT(dominant_mode({{1, 20, 500}, 1e6, 0, 1e-3}).radius, 1.1);
    EXPECT_GT(dominant_mode({{1, 0, 500}, 200, 0, 1e-3}).radius, 1);
    EXPECT_EQ(critical_sampled_stiffness({{1, 0, 500}, 200, 0, 1e-3}).stiffness_N_per_m, 0);
    EXPECT_FALSE(critical_steps({{1, 20, 500}, 300, 0, 1e-3}));
    // A long step: the loop jumps over the wall and back, z = -1.
    const SampledLoop coarse{{0.01, 100, 0}, 1, 0, 0.1};
    EXPECT_NEAR(critical_sampled_stiffness(coarse).angle_rad, std::numbers::pi, 1e-9);
    expect_relative(critical_sampled_stiffness(coarse).stiffness_N_per_m, 2 * 100 / 0.1, 0.01, "2 b / h");
    EXPECT_THROW(dominant_mode({{1, 20, 500}, 300, 0, 0}), Error);
    EXPECT_THROW(dominant_mode({{1, 20, 500}, 300, 1e5, 1e-9}), Error);
}

// How often p(z) turns round zero along the circle, step by step.
int wound(const PulsePolynomial<double>& p, double radius) {
    using Complex = std::complex<double>;
    const auto value = [&](double theta) {
        const Complex z = std::polar(radius, theta);
        return std::pow(z, p.power) * (z * z + p.hand[1] * z + p.hand[0]) +
               p.gain * (p.feedback[2] * z * z + p.feedback[1] * z + p.feedback[0]);
    };
    constexpr int kPoints = 6000;
    double turned = 0;
    Complex before = value(0);
    for (int i = 1; i <= kPoints; ++i) {
        const Complex now = value(2 * std::numbers::pi * i / kPoints);
        turned += std::arg(now / before);
        before = now;
    }
    return static_cast<int>(std::lround(turned / (2 * std::numbers::pi)));
}

double log_range(double low, double high) {
    constexpr int kSteps = 1 << 20;
    return low * std::pow(high / low, *rc::gen::inRange(0, kSteps) / static_cast<double>(kSteps));
}

// Without delay it is Colgate's 2 b / T.
TEST(SampledLoop, HalfASampleCountsAsDelayForPassivity) {
    EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m({{1, 20, 500}, 0, 0, 1e-3}), 40'000);
    EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m({{1, 20, 500}, 0, 0.0005, 1e-3}), 20'000);
}

TEST(SampledLoop, CountsWhatTheContourCounts) {
    const auto agrees = [] {
        const SampledLoop loop{{log_range(0.05, 5), log_range(0.1, 50), log_range(10, 2000)},
                               log_range(10, 1e5),
                               log_range(1e-4, 0.1),
                               1e-3};
        const auto exact = pulse_polynomial(loop);
        const auto p = in_doubles(exact);
        const double radius = log_range(0.9, 1.15);
        const int outside = static_cast<int>(p.power) + 2 - wound(p, radius);
        RC_ASSERT(Circle<double>(p, radius).roots_outside() == outside);
        RC_ASSERT(Circle<Precise>(exact, Precise(radius)).roots_outside() == outside);
    };
    EXPECT_TRUE(rc::check("the same number of roots", agrees));
}

}  // namespace
}  // namespace thimble
