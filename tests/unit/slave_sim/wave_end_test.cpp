// The slave's end of wave variables: each of the master's samples once, in order, whatever the network does.
#include "common/control/wave_end.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "slave_sim/slave_node.hpp"

namespace thimble {
namespace {

constexpr double kImpedance_Ns_per_m = 20;

// Without a damper: this master feels no drag, and would leave the needle behind.
WaveEnd undamped_end() { return WaveEnd({kImpedance_Ns_per_m, 1e-3, 0}, {}, kHandleFullScale_N); }

SlaveControl of(Compensator compensator) {
    SlaveControl settings;
    settings.control.compensator = compensator;
    settings.control.wave_slave_damping_Ns_per_m = 0;
    return settings;
}

// A master that moves at 5 mm/s of hand and feels nothing.
class MovingMaster {
  public:
    NeedleWave next() {
        position_m_ += 5e-6;
        NeedleWave message;
        message.command.position_hand_m = position_m_;
        message.waves = sender_.add(master_.wave_out(position_m_, 0));
        return message;
    }

  private:
    WaveMaster master_{{20, 1e-3}};
    WaveSender sender_{{}};
    double position_m_ = 0;
};

std::uint32_t receive(WaveEnd& end, const NeedleWave& message) {
    return end.receive(message.command.position_hand_m, message.waves);
}

// Of a needle at three times the hand, in its frame.
double step(WaveEnd& end, double plane_m, double stiffness_N_per_m) {
    return kPositionScale * end.step_m({plane_m / kPositionScale, kPositionScale * stiffness_N_per_m}, 0);
}

// Steps as often as the message has samples for; the needle afterwards, or `needle_m` if there were none.
double take(WaveEnd& end, const NeedleWave& message, double needle_m = 0, double plane_m = 1) {
    for (std::uint32_t left = receive(end, message); left > 0; --left) needle_m = step(end, plane_m, 0);
    return needle_m;
}

TEST(WaveEnd, RepeatsMakeGoodForLosses) {
    WaveEnd complete = undamped_end(), lossy = undamped_end();
    MovingMaster master;
    double complete_m = 0, lossy_m = 0;
    for (int n = 0; n < 200; ++n) {
        const NeedleWave message = master.next();
        complete_m = take(complete, message, complete_m);
        if (n % 5 != 1 && n % 5 != 2) lossy_m = take(lossy, message, lossy_m);
    }
    EXPECT_EQ(lossy_m, complete_m);
    EXPECT_EQ(lossy.burst().number, 199U);
    EXPECT_EQ(lossy.burst().count, 4U);
}

TEST(WaveEnd, WhatComesLateOrTwiceMovesNothing) {
    WaveEnd end = undamped_end();
    MovingMaster master;
    const NeedleWave first = master.next(), second = master.next();
    for (const auto& [message, samples] :
         {std::pair{&first, 1U}, {&first, 0U}, {&second, 1U}, {&first, 0U}}) {
        ASSERT_EQ(receive(end, *message), samples);
        if (samples > 0) step(end, 1, 0);
    }
}

TEST(WaveEnd, AfterALongGapItStepsNoMoreThanItsMostAndSaysNothingTwice) {
    WaveEnd end = undamped_end();
    MovingMaster master;
    take(end, master.next());
    for (int n = 0; n < 500; ++n) master.next();
    const std::uint32_t samples = receive(end, master.next());
    EXPECT_EQ(samples, WaveEnd::kMostAtOnce);
    step(end, 1, 0);
    EXPECT_EQ(end.burst().count, 1U) << "what is repeated must have the number it had";
    EXPECT_EQ(end.burst().number, 501 - samples + 1);
}

TEST(WaveEnd, AGapOfAsManyAsItTakesAtOnceIsNoneYet) {
    for (const std::uint32_t missing : {WaveEnd::kMostAtOnce - 1, WaveEnd::kMostAtOnce}) {
        WaveEnd end = undamped_end();
        MovingMaster master;
        receive(end, master.next());
        step(end, 1, 0);
        for (std::uint32_t n = 0; n < missing; ++n) master.next();
        EXPECT_EQ(receive(end, master.next()), WaveEnd::kMostAtOnce);
        step(end, 1, 0);
        EXPECT_EQ(end.burst().count, missing < WaveEnd::kMostAtOnce ? 2U : 1U);
    }
}

// Lost for good: the needle stays behind, and goes back to the hand before the plane.
TEST(WaveEnd, GoesBackToTheHandWhereNothingHoldsIt) {
    for (const double plane_m : {1.0, -1.0}) {  // before it, or beyond
        WaveEnd end = undamped_end();
        MovingMaster master;
        double needle_m = 0, hand_m = 0;
        for (int n = 0; n < 400; ++n) {
            const NeedleWave message = master.next();
            hand_m = message.command.position_hand_m;
            if (n >= 100 && n < 120) continue;
            needle_m = take(end, message, needle_m, plane_m);
        }
        if (plane_m > 0) {
            EXPECT_NEAR(needle_m, 3 * hand_m, 5e-4);
        } else {
            EXPECT_LT(needle_m, 3 * hand_m - 5e-4 * 0.3);
        }
    }
}

// A steady wave u presses with sqrt(2 b) u at the hand: the needle is then that far beyond the plane, as its stiffness says.
TEST(WaveEnd, ASteadyWaveLeansOnThePlanesStiffness) {
    constexpr double kPlane_m = 0.01, kStiffness_N_per_m = 1000, kWave_root_W = 0.5;
    WaveEnd end = undamped_end();
    WaveSender sender{{}};
    double needle_m = 0;
    for (int n = 0; n < 2000; ++n) {
        NeedleWave message;
        message.waves = sender.add(kWave_root_W);
        receive(end, message);
        needle_m = step(end, kPlane_m, kStiffness_N_per_m);
    }
    const double force_N = std::sqrt(2 * kImpedance_Ns_per_m) * kWave_root_W;
    EXPECT_NEAR(needle_m - kPlane_m, force_N / kStiffness_N_per_m, 1e-9);
}

// A slave with such an end, and a fixture at 3 mm.
struct SlaveWithWaves {
    explicit SlaveWithWaves(const SlaveControl& settings) : node(with(settings)) { start(Modality::kHF); }
    static SlaveSettings with(const SlaveControl& control) {
        SlaveSettings settings;
        settings.control = control;
        return settings;
    }
    void start(Modality modality) {
        SessionControl order;
        order.fixture_position_m = 0.003;
        order.modality = modality;
        node.start_trial(order);
    }
    ForceFeedback take(int ms, std::uint32_t sequence, const NeedleWave& message) {
        return node.on_wave(SessionTime{std::chrono::milliseconds{ms}}, sequence, message);
    }

    SlaveNode node;
    MovingMaster master;
};

TEST(WaveEnd, InASlaveTheFixtureStopsTheNeedleAndTheWaveSaysSo) {
    SlaveWithWaves slave(of(Compensator::kWave));
    ASSERT_TRUE(slave.node.waves());
    ForceFeedback feedback;
    for (std::uint32_t n = 0; n < 600; ++n)
        feedback = slave.take(static_cast<int>(n) + 1000, n, slave.master.next());
    EXPECT_GT(feedback.position_needle_m, 0.003);
    EXPECT_LT(feedback.position_needle_m, 0.0035) << "the hand is at 9 mm";
    EXPECT_LT(feedback.force_fixture_N, -0.05);
    EXPECT_LT(slave.node.wave_burst().wave_root_W[0], 0);
    EXPECT_GT(feedback.contact_time_s, 0.3);
    EXPECT_EQ(slave.node.refused(), 0U);
    slave.start(Modality::kCF);
    EXPECT_FALSE(slave.node.waves());
}

TEST(WaveEnd, InASlaveASteadyWavePressesAsTheHandDoes) {
    constexpr double kWave_root_W = 0.5;
    SlaveWithWaves slave(of(Compensator::kWave));
    WaveSender sender{{}};
    ForceFeedback feedback;
    for (std::uint32_t n = 0; n < 2000; ++n) {
        NeedleWave message;
        message.waves = sender.add(kWave_root_W);
        feedback = slave.take(static_cast<int>(n) + 1000, n, message);
    }
    EXPECT_NEAR(feedback.force_fixture_N, -std::sqrt(2 * kImpedance_Ns_per_m) * kWave_root_W, 1e-6);
}

// A hand that presses takes energy out of the network at this end, and brings none into it.
TEST(WaveEnd, InASlaveOfTwoPortsPressingTakesEnergyOut) {
    SlaveWithWaves slave(of(Compensator::kTwoPort));
    NeedleWave message;
    message.waves.energy_J = 10;  // more than enough was told
    ForceFeedback feedback;
    for (std::uint32_t n = 0; n < 500; ++n) {
        message.command.position_hand_m = 5e-6 * n;
        feedback = slave.take(static_cast<int>(n) + 1000, n, message);
    }
    EXPECT_LT(feedback.force_fixture_N, -0.05);
    EXPECT_EQ(slave.node.wave_burst().energy_J, 0);
}

// The oldest of the samples that a message brings would lie before the clock's origin.
TEST(WaveEnd, InASlaveSamplesFromBeforeTheOriginAreRefused) {
    SlaveWithWaves slave(of(Compensator::kWave));
    slave.take(5, 0, slave.master.next());
    EXPECT_EQ(slave.node.refused(), 0U);
    for (int n = 0; n < 10; ++n) slave.master.next();
    slave.take(10, 1, slave.master.next());
    EXPECT_EQ(slave.node.refused(), 1U);
}

}  // namespace
}  // namespace thimble
