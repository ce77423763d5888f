// The running loop with compensators and a bad network: against the loop without, and against the study's traces.
#include "study/maps/compensated_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {
namespace {

CompensatedConditions held_at(double stiffness_N_per_m, double delay_s, const HeldMass& hand = {1, 20, 500}) {
    CompensatedConditions c;
    c.loop.loop = {hand, stiffness_N_per_m, delay_s, 1e-3};
    c.loop.one_sided = true;
    c.loop.force_limit_N = 12;
    c.loop.press_N = 5;
    c.loop.encoder_step_m = 1e-5;
    return c;
}

HoldOutcome hold_of(const CompensatedConditions& c) {
    const HoldPlan plan;
    CompensatedLoop run(c, plan.start_m, plan.start_m_per_s);
    return watched_hold(run, plan, c.loop.loop.step_s);
}

TEST(CompensatedLoop, WithNothingInTheWayItIsThePlainLoop) {
    for (const double delay_s : {0.0, 0.0004, 0.005, 0.0503}) {
        for (const double friction_N : {0.0, 0.1}) {
            CompensatedConditions c = held_at(9000, delay_s);
            c.loop.friction_N = friction_N;
            CompensatedLoop run(c, -5e-3, 0.1);
            LoopSimulator plain(c.loop, -5e-3, 0.1);
            for (int i = 0; i < 3000; ++i) {
                run.step();
                plain.step();
                ASSERT_NEAR(run.position_m(), plain.position_m(), 1e-11) << delay_s << ' ' << i;
            }
            EXPECT_NEAR(run.effective_delay_s(), delay_s + 0.5e-3, 1e-6) << delay_s;
            EXPECT_NEAR(run.energy_J(), plain.energy_J(), 1e-9);
        }
    }
}

// Jitter alone makes the stable loop without delay unstable, and waves, which wait for the late, keep it.
TEST(CompensatedLoop, JitterThatOvertakesAndLossInBursts) {
    CompensatedConditions c = held_at(9000, 0);
    EXPECT_EQ(hold_of(c).label, HoldClass::kSettles);
    c.jitter_s = 0.005;
    EXPECT_EQ(hold_of(c).label, HoldClass::kOscillates);
    c.control.compensator = Compensator::kWave;
    EXPECT_EQ(hold_of(c).label, HoldClass::kSettles);
    c.jitter_s = 0;
    c.loss = 0.2;
    c.mean_burst = 100;  // longer than any delay here
    c.control.compensator = Compensator::kNone;
    EXPECT_EQ(hold_of(c).label, HoldClass::kOscillates);
}

// With any network a bound lets no more energy out than the device's damping takes. Without a bound there is no limit.
TEST(CompensatedLoop, ABoundHoldsOnAnyNetwork) {
    for (const double loss : {0.0, 0.3}) {
        for (const double jitter_s : {0.0, 0.02}) {
            for (const Compensator compensator :
                 {Compensator::kMemorylessBound, Compensator::kLeastConservative, Compensator::kTwoLayer}) {
                CompensatedConditions c = held_at(9000, 0.05);
                c.loop.encoder_step_m = 0;
                c.loss = loss;
                c.mean_burst = loss > 0 ? 60 : 1;
                c.jitter_s = jitter_s;
                c.control.compensator = compensator;
                CompensatedLoop run(c, -5e-3, 0.1);
                double dissipated_J = 0, before_m = run.position_m(), least_J = 0;
                for (int i = 0; i < 4000; ++i) {
                    run.step();
                    const double moved_m = run.position_m() - before_m;
                    dissipated_J += c.control.device_damping_Ns_per_m * moved_m * moved_m / 1e-3;
                    before_m = run.position_m();
                    least_J = std::min(least_J, run.energy_J() + dissipated_J);
                }
                EXPECT_GE(least_J, -1e-9) << static_cast<int>(compensator) << ' ' << loss << ' ' << jitter_s;
                c.control.compensator = Compensator::kNone;
                CompensatedLoop bare(c, -5e-3, 0.1);
                for (int i = 0; i < 4000; ++i) bare.step();
                EXPECT_LT(bare.energy_J(), -0.1);
            }
        }
    }
}

// None falls through to the plain loop: where that oscillates, each moves the hand elsewhere within half a second.
TEST(CompensatedLoop, EveryCompensatorIsInTheLoop) {
    for (std::size_t i = 1; i < kBuiltInCompensators.size(); ++i) {
        CompensatedConditions c = held_at(9000, 0.05);
        LoopSimulator plain(c.loop, 0, 0.05);
        c.control.compensator = static_cast<Compensator>(i);
        c.control.share = 0.5;
        CompensatedLoop run(c, 0, 0.05);
        double farthest_m = 0;
        for (int k = 0; k < 500; ++k) {
            run.step();
            plain.step();
            farthest_m = std::max(farthest_m, std::abs(run.position_m() - plain.position_m()));
        }
        EXPECT_GT(farthest_m, 1e-4) << kCompensatorNames.at(i);
    }
}

TEST(CompensatedLoop, TwoPortsEndTheOscillation) {
    CompensatedConditions c = held_at(9000, 0.05);
    EXPECT_EQ(hold_of(c).label, HoldClass::kOscillates);
    c.control.compensator = Compensator::kTwoPort;
    EXPECT_NE(hold_of(c).label, HoldClass::kOscillates);
}

TEST(CompensatedLoop, RefusesWhatIsNoNetworkAndNoImpedance) {
    const auto refused = [](const auto& change) {
        CompensatedConditions c = held_at(9000, 0.01);
        change(c);
        EXPECT_THROW(CompensatedLoop(c, 0, 0), Error);
    };
    refused([](auto& c) { c.loss = 0.6; });
    refused([](auto& c) { c.loss = -0.1; });
    refused([](auto& c) { c.jitter_s = std::nan(""); });
    refused([](auto& c) { c.mean_burst = 0.5; });
    for (const double impedance : {0.0, std::numeric_limits<double>::infinity()})
        refused([&](auto& c) {
            c.control.compensator = Compensator::kWave;
            c.control.wave_impedance_Ns_per_m = impedance;
        });
}

}  // namespace
}  // namespace thimble
