// Predictors of the limit cycle against orbits integrated to 12 digits (method of steps), and laws of the orbit.
#include "stability/limit_cycle.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/unit/stability/golden_loops.hpp"

namespace thimble {
namespace {

PressedLoop pressed(const nlohmann::json& c) {
    return {hand_of(c), figure(c, "K"), figure(c, "T"), figure(c, "Fs"), figure(c, "F0")};
}

TEST(LimitCycle, BothPredictorsAsComputedBefore) {
    for (const auto& c : golden_loops("limit_cycles_continuous")) {
        const auto harmonic = describing_function_cycle(pressed(c));
        ASSERT_TRUE(harmonic);
        expect_relative(harmonic->amplitude_m, figure(c.at("DF"), "A"), 1e-9, c.at("set"));
        expect_relative(harmonic->frequency_rad_per_s, figure(c.at("DF"), "w"), 1e-9, c.at("set"));
        expect_relative(harmonic->mean_m, figure(c.at("DF"), "p0"), 1e-8, c.at("set"));
        const auto relay = relay_orbit(pressed(c), *harmonic);
        ASSERT_TRUE(relay) << c.at("set");
        const auto& expected = c.at("relay_limit");
        expect_relative(2 * std::numbers::pi / relay->frequency_rad_per_s, figure(expected, "P"), 1e-9,
                        c.at("set"));
        expect_relative(relay->amplitude_m, figure(expected, "A"), 2e-6, c.at("set"));
        // Their extremes are those of a grid of points.
        expect_relative(relay->duty, figure(expected, "duty"), 1e-9, c.at("set"));
        expect_relative(relay->lowest_m, figure(expected, "pmin"), 2e-6, c.at("set"));
        expect_relative(relay->highest_m, figure(expected, "pmax"), 2e-6, c.at("set"));
    }
}

TEST(LimitCycle, ForecastsTheOrbit) {
    for (const auto& c : golden_loops("limit_cycles_continuous")) {
        const PressForecast forecast = forecast_press(pressed(c));
        ASSERT_TRUE(forecast.cycle);
        EXPECT_EQ(forecast.predictor, CyclePredictor::kRelayOrbit);
        EXPECT_FALSE(forecast.rest_is_stable);
        const double amplitude = (figure(c, "p_max") - figure(c, "p_min")) / 2;
        expect_relative(forecast.cycle->amplitude_m, amplitude, 0.01, c.at("set"));
        expect_relative(forecast.cycle->frequency_rad_per_s, 2 * std::numbers::pi / figure(c, "period"),
                        0.005, c.at("set"));
        EXPECT_EQ(forecast.cycle->lowest_m > 0, c.at("keeps_contact").get<bool>());
    }
}

// An orbit that touches one border of the linear strip only scales with its distance from there: E at 5 ms, 3 N and 9 N.
TEST(LimitCycle, OneBorderScales) {
    const PressedLoop low{{2, 40, 1000}, 9000, 0.005, 12, 3};
    PressedLoop high = low;
    high.press_N = 9;
    const auto a = describing_function_cycle(low), b = describing_function_cycle(high);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->frequency_rad_per_s, b->frequency_rad_per_s, 1e-9);
    const double strip_m = 12.0 / 9000;
    EXPECT_NEAR(b->amplitude_m / a->amplitude_m, (strip_m - 9.0 / 10000) / (3.0 / 10000), 1e-9);
    EXPECT_LT(a->lowest_m, 0);
    EXPECT_GT(b->lowest_m, 0);  // pressed harder, it saturates instead of letting go
    EXPECT_EQ(forecast_press(low).predictor, CyclePredictor::kDescribingFunction);
}

// p -> p_s - p, F_0 -> F_s + k p_s - F_0.
TEST(LimitCycle, Mirrored) {
    PressedLoop loop{{1, 20, 500}, 9000, 0.05, 12, 4};
    const auto one = forecast_press(loop).cycle;
    const double strip_m = 12.0 / 9000;
    loop.press_N = 12 + 500 * strip_m - 4;
    const auto other = forecast_press(loop).cycle;
    ASSERT_TRUE(one && other);
    EXPECT_NEAR(one->amplitude_m, other->amplitude_m, 1e-9);
    EXPECT_NEAR(one->lowest_m, strip_m - other->highest_m, 1e-9);
}

TEST(LimitCycle, NoneWhereTheLoopIsStable) {
    const PressForecast forecast = forecast_press({{1, 20, 500}, 9000, 0.001, 12, 6});
    EXPECT_FALSE(forecast.cycle);
    EXPECT_TRUE(forecast.rest_is_stable);
    EXPECT_NEAR(forecast.rest_m, 6.0 / 9500, 1e-15);
}

TEST(LimitCycle, AHandThatPressesHarderThanTheHandlePushesThrough) {
    const PressForecast forecast = forecast_press({{1, 20, 500}, 9000, 0.05, 12, 20});
    EXPECT_TRUE(forecast.pushed_through);
    EXPECT_TRUE(forecast.rest_is_stable);
    EXPECT_NEAR(forecast.rest_m, 8.0 / 500, 1e-15);
    EXPECT_FALSE(forecast.cycle);  // past the fold nothing else is left
    EXPECT_TRUE(forecast_press({{1, 20, 500}, 9000, 0.05, 12, 13}).cycle);
    // The hand's own spring takes a part of the press: 12 N at the handle hold 12 (1 + 500 / 9000) = 12.67 N.
    EXPECT_FALSE(forecast_press({{1, 20, 500}, 9000, 0.05, 12, 12.6}).pushed_through);
    EXPECT_TRUE(forecast_press({{1, 20, 500}, 9000, 0.05, 12, 12.7}).pushed_through);
}

// D at 50 ms with 0.05 N of friction: below the threshold simulations decay, above they grow.
TEST(LimitCycle, FrictionHidesSmallOscillations) {
    const HeldMass hand{1, 20, 500};
    const double critical = critical_stiffness(hand, 0.05).stiffness_N_per_m;
    EXPECT_NEAR(friction_threshold_m({hand, 1.05 * critical, 0}, 0.05, 0.05), 2.62e-3, 0.01e-3);
    EXPECT_NEAR(friction_threshold_m({hand, 1.2 * critical, 0}, 0.05, 0.05), 0.65e-3, 0.01e-3);
    EXPECT_NEAR(friction_threshold_m({hand, 1.5 * critical, 0}, 0.05, 0.05), 0.26e-3, 0.01e-3);
    EXPECT_TRUE(std::isinf(friction_threshold_m({hand, 0.9 * critical, 0}, 0.05, 0.05)));
    const NeededDamping needed = needed_damping({hand, 2 * critical, 0}, 0.05);
    expect_relative(critical_stiffness({1, needed.damping_Ns_per_m, 500}, 0.05).stiffness_N_per_m,
                    2 * critical, 1e-9, "K*(b_c)");
}

TEST(LimitCycle, AnEncoderStepChattersUnlessFrictionHoldsIt) {
    EXPECT_NEAR(encoder_chatter_m(9000, 13409.7, 1e-5, 0), 4.3e-6, 0.1e-6);
    EXPECT_EQ(encoder_chatter_m(9000, 13409.7, 1e-5, 0.0451), 0);
}

TEST(LimitCycle, RefusesAHandThatNothingHolds) {
    EXPECT_THROW(forecast_press({{1, 20, 0}, 9000, 0.05, 12, 6}), Error);
    EXPECT_THROW(forecast_press({{1, 20, 500}, 9000, 0.05, 0, 6}), Error);
}

}  // namespace
}  // namespace thimble
