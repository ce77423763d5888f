// The loops on which classes go wrong: theory beside what is measured, and where neither can say (docs/stability.md, "Hard cases").
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "stability/delayed_loop.hpp"
#include "stability/loop_measures.hpp"
#include "stability/stability_map.hpp"
#include "study/maps/compensated_loop.hpp"

namespace thimble {
namespace {

// Never the wrong one farther than 2 % from the boundary; marginal is an answer too, where growth is slower than the measure's limit.
void expect_right(const SampledLoop& loop, double critical_N_per_m, int& decided) {
    const double apart = std::log(loop.stiffness_N_per_m / critical_N_per_m);
    const GrowthClass measured = growth_class(measured_growth_per_s(loop, 0));
    if (std::abs(apart) < 0.02 || measured == GrowthClass::kMarginal) return;
    ++decided;
    EXPECT_EQ(measured == GrowthClass::kUnstable, apart > 0)
        << "m " << loop.hand.mass_kg << " b " << loop.hand.damping_Ns_per_m << " k "
        << loop.hand.stiffness_N_per_m << " K " << loop.stiffness_N_per_m << " T " << loop.delay_s
        << " growth " << measured_growth_per_s(loop, 0);
}

TEST(HardCases, DelaysOfNothingOfPartsOfAStepAndOfSeconds) {
    int decided = 0;
    for (const HeldMass& hand : {HeldMass{0.35, 6, 400}, HeldMass{1, 20, 500}}) {
        for (const double delay_s : {0.0, 1e-6, 0.0003, 0.0009999, 0.0503, 0.01234, 1.0, 3.0005}) {
            SampledLoop loop{hand, 1, delay_s, 1e-3};
            const double critical = critical_sampled_stiffness(loop).stiffness_N_per_m;
            for (const double over : {0.7, 0.97, 1.03, 1.5}) {
                loop.stiffness_N_per_m = over * critical;
                expect_right(loop, critical, decided);
            }
        }
    }
    EXPECT_GE(decided, 56);
}

TEST(HardCases, ContactsAndMassesOverDecades) {
    int decided = 0;
    for (const double mass_kg : {0.01, 0.1, 1.0, 10.0, 100.0}) {
        for (const double delay_s : {0.0, 0.005, 0.1}) {
            SampledLoop loop{{mass_kg, 20, 500}, 1, delay_s, 1e-3};
            const double critical = critical_sampled_stiffness(loop).stiffness_N_per_m;
            for (const double stiffness : {1.0, 1e2, 1e4, 1e5, 1e7}) {
                loop.stiffness_N_per_m = stiffness;
                expect_right(loop, critical, decided);
            }
        }
    }
    EXPECT_GE(decided, 65);
}

// A hand that loses nothing swings up under any contact: at once with delay, through the hold without.
TEST(HardCases, WithoutDampingNothingIsStable) {
    for (const double delay_s : {0.0, 0.001, 0.05}) {
        const SampledLoop loop{{1, 0, 500}, 2000, delay_s, 1e-3};
        EXPECT_EQ(growth_class(measured_growth_per_s(loop, 0)), GrowthClass::kUnstable) << delay_s;
        EXPECT_EQ(unstable_roots({loop.hand, 2000, 0}, delay_s) > 0, delay_s > 0);
        EXPECT_GT(growing_modes(loop), 0);
    }
    // Slower than a tenth in six seconds, it is marginal and not stable.
    EXPECT_NE(growth_class(measured_growth_per_s({{100, 0, 500}, 1, 0, 1e-3}, 0)), GrowthClass::kStable);
}

// A contact softer than the hand: stable again with more delay, and unstable again with still more.
TEST(HardCases, StableAgainAtLargerDelays) {
    const DelayedLoop loop{{1, 2, 500}, 100, 0};
    const auto windows = stable_delays(loop, 64);
    ASSERT_GE(windows.size(), 3U);
    int decided = 0;
    for (std::size_t i = 0; i + 1 < windows.size(); ++i) {
        const double within_s = (windows[i].from_s + windows[i].to_s) / 2,
                     between_s = (windows[i].to_s + windows[i + 1].from_s) / 2;
        const auto measured = [&](double delay_s) {
            return growth_class(measured_growth_per_s({loop.hand, 100, delay_s - 5e-5, 1e-4}, 0));
        };
        for (const auto& [delay_s, wrong] :
             {std::pair{within_s, GrowthClass::kUnstable}, std::pair{between_s, GrowthClass::kStable}}) {
            const GrowthClass found = measured(delay_s);
            EXPECT_NE(found, wrong) << delay_s;
            decided += found != GrowthClass::kMarginal;
        }
    }
    EXPECT_GE(decided, 4);
}

CompensatedConditions pressed(double stiffness_N_per_m, double delay_s, double press_N) {
    CompensatedConditions c;
    c.loop.loop = {{1, 20, 500}, stiffness_N_per_m, delay_s, 1e-3};
    c.loop.one_sided = true;
    c.loop.force_limit_N = 12;
    c.loop.press_N = press_N;
    c.loop.encoder_step_m = 1e-5;
    return c;
}

struct WatchedHold {
    HoldOutcome outcome;
    bool always_limited = true;  // in the watched seconds
    bool finite = true;
};

WatchedHold watched(const CompensatedConditions& c) {
    const HoldPlan plan;
    CompensatedLoop run(c, plan.start_m, plan.start_m_per_s);
    HoldWatch watch(plan, c.loop.loop.step_s);
    WatchedHold result;
    const double strip_m = c.loop.force_limit_N / c.loop.loop.stiffness_N_per_m;
    for (long i = 0; !watch.over(); ++i) {
        const double before_m = run.sampled_m();
        run.step();
        watch.add(before_m, run.sampled_m(), run.position_m(), run.energy_J());
        if (i > 9000) result.always_limited &= run.sampled_m() >= strip_m;
        result.finite &= std::isfinite(run.position_m()) && std::isfinite(run.energy_J());
    }
    result.outcome = watch.outcome();
    return result;
}

// Pushed through, the force stays at its limit and says nothing of where the hand is: settled, at any delay and stiffness.
TEST(HardCases, SaturationAlwaysOn) {
    for (const double delay_s : {0.0, 0.05, 1.0}) {
        for (const double stiffness : {9000.0, 1e7}) {
            const WatchedHold hold = watched(pressed(stiffness, delay_s, 20));
            EXPECT_TRUE(hold.always_limited) << delay_s;
            EXPECT_EQ(hold.outcome.label, HoldClass::kSettles) << delay_s;
        }
    }
}

// Packets that overtake each other by more than the delay, and bursts longer than it: numbers stay numbers, and what waits for the
// late or bounds the energy still settles.
TEST(HardCases, JitterBeyondTheDelayAndBurstsLongerThanIt) {
    for (const Compensator compensator :
         {Compensator::kNone, Compensator::kLeastConservative, Compensator::kWave}) {
        CompensatedConditions c = pressed(9000, 0.01, 5);
        c.control.compensator = compensator;
        c.jitter_s = 0.04;
        const WatchedHold shaken = watched(c);
        EXPECT_TRUE(shaken.finite);
        c.jitter_s = 0;
        c.loss = 0.1;
        c.mean_burst = 30;
        const WatchedHold burst = watched(c);
        EXPECT_TRUE(burst.finite);
        if (compensator == Compensator::kNone) {
            EXPECT_EQ(shaken.outcome.label, HoldClass::kOscillates);
            EXPECT_EQ(burst.outcome.label, HoldClass::kOscillates);
        } else {
            EXPECT_FALSE(shaken.outcome.energy_grows);
            EXPECT_FALSE(burst.outcome.energy_grows);
            EXPECT_EQ(shaken.outcome.label, HoldClass::kSettles) << static_cast<int>(compensator);
        }
    }
}

// 0 and infinity are refused (CompensatedLoop.RefusesWhatIsNoNetworkAndNoImpedance). Towards 0 the wave is a soft contact, towards 2 m/h
// a stiff damper; both ends still settle.
TEST(HardCases, WaveImpedancesOverDecades) {
    for (const double impedance : {0.01, 1.0, 20.0, 400.0}) {
        CompensatedConditions c = pressed(9000, 0.05, 5);
        c.control.compensator = Compensator::kWave;
        c.control.wave_impedance_Ns_per_m = impedance;
        c.control.wave_slave_damping_Ns_per_m = impedance;
        const WatchedHold hold = watched(c);
        EXPECT_TRUE(hold.finite) << impedance;
        EXPECT_NE(hold.outcome.label, HoldClass::kOscillates) << impedance;
        EXPECT_GT(hold.outcome.energy_J, -1e-4) << impedance;
    }
}

}  // namespace
}  // namespace thimble
