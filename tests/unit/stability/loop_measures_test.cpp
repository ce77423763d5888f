// The loop that runs: traces at 40 digits, and what is measured on it against theory.
#include "stability/loop_measures.hpp"

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stability/limit_cycle.hpp"
#include "stability/stability_map.hpp"
#include "tests/unit/stability/golden_loops.hpp"

namespace thimble {
namespace {

// A hand that presses against a wall of 12 N at most.
LoopConditions walled(const SampledLoop& loop, double press_N) {
    LoopConditions conditions;
    conditions.loop = loop;
    conditions.one_sided = true;
    conditions.force_limit_N = 12;
    conditions.press_N = press_N;
    return conditions;
}

TEST(LoopSimulator, TracesAtFortyDigits) {
    for (const auto& c : golden_loops("traces_hf_exact_zoh")) {
        LoopConditions conditions;
        const double step_s = figure(c, "dt");
        conditions.loop = {hand_of(c), figure(c, "K"), figure(c, "d") * step_s, step_s};
        conditions.one_sided = true;
        conditions.force_limit_N = figure(c, "Fs");
        conditions.press_N = figure(c, "F0");
        LoopSimulator run(conditions, figure(c, "x0"), figure(c, "v0"));
        int steps = 0, losses = 0;
        for (const auto& sample : c.at("samples")) {
            for (; steps < sample[0].get<int>(); ++steps) {
                const bool touched = run.position_m() > 0;
                run.step();
                if (touched && !(run.position_m() > 0)) ++losses;
            }
            EXPECT_NEAR(run.position_m(), std::stod(sample[1].get<std::string>()), 1e-14) << steps;
            EXPECT_NEAR(run.velocity_m_per_s(), std::stod(sample[2].get<std::string>()), 1e-12) << steps;
        }
        EXPECT_EQ(losses, c.at("contact_losses").get<int>());
    }
}

TEST(LoopSimulator, AFractionOfAStepGrowsAsTheTheorySays) {
    for (const double delay_s : {0.0004, 0.0107, 0.0219}) {
        LoopConditions conditions;
        conditions.loop = {{1, 20, 500}, 9000, delay_s, 1e-3};
        LoopSimulator run(conditions, 1e-3, 0);
        std::vector<double> trace;
        trace.reserve(2000);
        for (int i = 0; i < 2000; ++i) {
            trace.push_back(run.position_m());
            run.step();
        }
        const auto tail = std::span<const double>(trace).subspan(1000);
        EXPECT_NEAR(growth_per_sample(tail), dominant_mode(conditions.loop).radius, 1e-9) << delay_s;
    }
}

// Two modes that change sign with each sample: their roots are real, and the slower one decides.
TEST(LoopMeasures, GrowthOfRealRoots) {
    std::vector<double> trace;
    for (int n = 0; n < 20; ++n) trace.push_back(std::pow(-0.9, n) + std::pow(-0.5, n));
    EXPECT_NEAR(growth_per_sample(trace), 0.9, 1e-9);
}

// Half a step of the measuring loop is a delay of its own, 50 us here.
TEST(LoopMeasures, CriticalDelayIsThatOfTheTheory) {
    for (const auto& [name, hand] : kTypicalHands) {
        const double theory_s = critical_point({hand, 9000, 0}).delay_s;
        EXPECT_NEAR(measured_critical_delay_s(hand, 9000), theory_s, 5e-6) << name;
    }
}

// Contact that is lost once a second oscillates, however small the swing.
TEST(LoopMeasures, HowOftenContactIsLostDecides) {
    for (const int losses : {2, 3}) {
        HoldWatch watch({}, 1e-3);
        for (int i = 0; !watch.over(); ++i) {
            const bool lost = i >= 10000 && i < 10000 + losses;
            watch.add(1e-6, lost ? -1e-6 : 1e-6, 0, 0);
        }
        EXPECT_EQ(watch.outcome().losses_per_s, losses / 3.0);
        EXPECT_EQ(watch.outcome().label, losses == 3 ? HoldClass::kOscillates : HoldClass::kMarginal);
    }
}

// Every hand and delay of the study: within 0.5 % without and 1 % with the encoder of 10 um.
TEST(LoopMeasures, CriticalStiffnessOfEveryHandAndDelay) {
    for (const auto& [name, hand] : kTypicalHands) {
        for (const double delay_s : {0.0, 0.001, 0.002, 0.005, 0.010, 0.025, 0.050, 0.100, 0.200}) {
            const SampledLoop loop{hand, 0, delay_s, 1e-3};
            SampledLoop any = loop;
            any.stiffness_N_per_m = 1;
            const double theory = critical_sampled_stiffness(any).stiffness_N_per_m;
            expect_relative(measured_critical_stiffness(loop, 0, 1e-4).stiffness_N_per_m, theory, 2e-4, name);
            expect_relative(measured_critical_stiffness(loop, 1e-5, 1e-3).stiffness_N_per_m, theory, 0.01,
                            name);
        }
    }
}

TEST(LoopMeasures, OutcomesOnBothSidesOfTheBoundary) {
    for (const auto& [name, hand] : kTypicalHands) {
        for (const double delay_s : {0.001, 0.002, 0.005, 0.010, 0.025, 0.050, 0.100, 0.200}) {
            LoopConditions conditions = walled({hand, 1, delay_s, 1e-3}, 5);
            conditions.encoder_step_m = 1e-5;
            const double critical = critical_sampled_stiffness(conditions.loop).stiffness_N_per_m;
            conditions.loop.stiffness_N_per_m = 0.75 * critical;
            EXPECT_EQ(measured_hold(conditions, {}).label, HoldClass::kSettles) << name << ' ' << delay_s;
            conditions.loop.stiffness_N_per_m = 1.5 * critical;
            const HoldOutcome beyond = measured_hold(conditions, {});
            EXPECT_EQ(beyond.label, HoldClass::kOscillates) << name << ' ' << delay_s;
            EXPECT_LT(beyond.energy_J, 0) << name << ' ' << delay_s;
        }
    }
}

// Continuous predictors, with half a step of delay for the hold: 1 % in amplitude.
TEST(LoopMeasures, TheLimitCycleIsTheForecastOne) {
    for (const auto& [name, hand] : kTypicalHands) {
        LoopConditions conditions = walled({hand, 9000, 0.05, 1e-3}, 5);
        const auto cycle = forecast_press({hand, 9000, 0.0505, 12, 5}).cycle;
        ASSERT_TRUE(cycle);
        const HoldOutcome hold = measured_hold(conditions, {});
        expect_relative(hold.peak_to_peak_m / 2, cycle->amplitude_m, 0.01, name);
        EXPECT_NEAR(hold.losses_per_s, cycle->frequency_rad_per_s / 2 / std::numbers::pi, 0.4) << name;
        EXPECT_TRUE(hold.energy_grows);
    }
}

// The rule of docs/stability.md for which predictor, at ten samples a millisecond: 1 % for the relay, 10 % for the describing function.
TEST(LoopMeasures, EitherPredictorIsAsGoodAsItsRuleSays) {
    int relays = 0, harmonics = 0;
    for (const auto& [name, hand] : kTypicalHands) {
        for (const double delay_s : {0.005, 0.010, 0.025, 0.100}) {
            LoopConditions conditions = walled({hand, 9000, delay_s, 1e-4}, 6);
            const PressForecast forecast = forecast_press({hand, 9000, delay_s + 5e-5, 12, 6});
            ASSERT_TRUE(forecast.cycle) << name << delay_s;
            HoldPlan plan;
            plan.duration_s = 8;
            const bool relay = forecast.predictor == CyclePredictor::kRelayOrbit;
            ++(relay ? relays : harmonics);
            const double amplitude_m = measured_hold(conditions, plan).peak_to_peak_m / 2;
            expect_relative(forecast.cycle->amplitude_m, amplitude_m, relay ? 0.01 : 0.1,
                            name + std::to_string(delay_s));
        }
    }
    EXPECT_GT(relays, 5);
    EXPECT_GE(harmonics, 5);
}

// Past the fold of the limit cycle a hand that presses harder than the handle keeps contact, deep behind the wall.
TEST(LoopMeasures, PushedThroughItHoldsAtAnyDelay) {
    LoopConditions conditions = walled({{1, 20, 500}, 9000, 0.05, 1e-3}, 14.1);
    EXPECT_EQ(measured_hold(conditions, {}).label, HoldClass::kSettles);
    conditions.press_N = 12;
    EXPECT_EQ(measured_hold(conditions, {}).label, HoldClass::kOscillates);
}

TEST(StabilityMap, NoCellIsOnTheWrongSide) {
    for (const HeldMass& hand : {HeldMass{0.15, 3, 300}, HeldMass{1, 20, 500}}) {
        MapPlan plan;
        plan.hand = hand;
        plan.delays_s = {0, 0.005, 0.0503, 0.2};  // the third is no whole number of steps
        plan.stiffness_N_per_m.reserve(21);
        for (int i = 0; i <= 20; ++i) plan.stiffness_N_per_m.push_back(45 * std::pow(2000, i / 20.0));
        for (std::size_t column = 0; column < plan.delays_s.size(); ++column) {
            int stable = 0, unstable = 0;
            for (const MapCell& cell : map_column(plan, column)) {
                const double apart = std::log(cell.stiffness_N_per_m / cell.critical_stiffness_N_per_m);
                stable += cell.growth == GrowthClass::kStable;
                unstable += cell.growth == GrowthClass::kUnstable;
                if (std::abs(apart) < 0.02 || cell.growth == GrowthClass::kMarginal) continue;
                EXPECT_EQ(cell.growth == GrowthClass::kUnstable, apart > 0)
                    << cell.delay_s << ' ' << cell.stiffness_N_per_m << ' ' << cell.growth_per_s;
            }
            EXPECT_GT(stable, 0);
            EXPECT_GT(unstable, 0);
        }
    }
}

}  // namespace
}  // namespace thimble
