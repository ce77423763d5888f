// The share for the hand, the local fixture, and the two-port controllers with their drift.
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "common/control/control_settings.hpp"
#include "common/control/two_port_passivity.hpp"
#include "tests/unit/control/compensator_loops.hpp"

namespace thimble::test {
namespace {

Controller scaled_wall(const HandCase& hand, std::size_t delay, double share) {
    HandCase unlimited = hand;
    unlimited.limit_N = 1e9;
    return [wall = plain_wall(unlimited, delay), share, limit_N = hand.limit_N](double x_m, double) {
        return ScaledForce{share}.hand_N(wall(x_m, 0), limit_N);
    };
}

// The critical share of this hand at 50 ms is 530.81 / 9000 (sampled-data theory).
TEST(ScaledForce, BelowTheCriticalShareItIsStable) {
    const HandCase hand;
    const double critical = 530.80781314 / hand.wall_N_per_m;
    EXPECT_LT(run_loop(hand, scaled_wall(hand, 50, 0.8 * critical), 20000).swing_m(), 0.1e-3);
    EXPECT_GT(run_loop(hand, scaled_wall(hand, 50, 1.5 * critical), 20000).swing_m(), 1e-3);
}

TEST(ScaledForce, HandAndSkinMakeTheWhole) {
    const ScaledForce scaled{0.25};
    EXPECT_DOUBLE_EQ(scaled.hand_N(8, 12) + scaled.skin_N(8), 8);
    EXPECT_EQ(scaled.hand_N(400, 12), 12) << "the limit is the handle's, not a share of it";
    EXPECT_EQ(scaled.hand_N(-400, 12), -12);
}

TEST(LocalFixture, LearnsPlaceAndStiffnessFromPairs) {
    LocalFixture fixture{LocalFixtureSettings{}};
    EXPECT_EQ(fixture.force_N(1), 0) << "nothing is known yet";
    learn_wall(fixture, 5000);
    EXPECT_NEAR(fixture.stiffness_N_per_m(), 5000, 1e-6);
    EXPECT_NEAR(fixture.position_m(), 0.04, 1e-12);
}

TEST(LocalFixture, KeepsItsStiffnessWhilePairsSayNothingAboutIt) {
    LocalFixture fixture{LocalFixtureSettings{}};
    fixture.learn(0.041, 4);
    EXPECT_EQ(fixture.stiffness_N_per_m(), 3000);
    EXPECT_NEAR(fixture.position_m(), 0.041 - 4.0 / 3000, 1e-12);
    fixture.learn(std::nan(""), 4);
    fixture.learn(0.041, std::nan(""));
    EXPECT_NEAR(fixture.position_m(), 0.041 - 4.0 / 3000, 1e-12);
}

TEST(LocalFixture, IsGoneOncePairsBeyondItAreWithoutForce) {
    LocalFixture fixture{LocalFixtureSettings{}};
    fixture.learn(0.041, 3);  // at 0.040
    fixture.learn(0.0415, 0);
    EXPECT_TRUE(fixture.known()) << "within what an estimate may be wrong";
    fixture.learn(0.0425, 0);
    EXPECT_FALSE(fixture.known());
    EXPECT_EQ(fixture.force_N(0.05), 0);
}

// However wrong, an estimate pushes with no more power than force x the speed at which the plane may move.
TEST(LocalFixture, AnEstimateDoesNotThrowTheHand) {
    LocalFixtureSettings settings;
    LocalFixture fixture(settings);
    fixture.learn(0.041, 3);
    double before_N = fixture.force_N(0.060);
    EXPECT_EQ(before_N, 0) << "the plane starts at the hand";
    for (int i = 0; i < 500; ++i) {
        if (i == 200) fixture.learn(-0.5, 3);
        fixture.next_sample();
        fixture.force_N(0.060);
        const double now_N = fixture.force_N(0.060);  // an answer in the sample's own instant
        EXPECT_LE(now_N - before_N,
                  fixture.stiffness_N_per_m() * settings.shift_m_per_s * settings.sample_period_s * 1.0001);
        before_N = now_N;
    }
}

TEST(LocalFixture, HoldsTheHandAtEveryDelayWithTheTrueStiffness) {
    for (const std::size_t delay : {0U, 10U, 50U, 200U}) {
        const HandCase hand;
        auto fixture = std::make_shared<LocalFixture>(LocalFixtureSettings{});
        const Controller controller = [&, there = DelayLine(delay), fixture](double x_m, double) mutable {
            const double then_m = there.pass(x_m);
            fixture->learn(then_m, hand.wall_N_per_m * std::max(then_m, 0.0));
            fixture->next_sample();
            return std::min(fixture->force_N(x_m), hand.limit_N);
        };
        const LoopResult result = run_loop(hand, controller, 8000);
        EXPECT_LT(result.swing_m(), 0.1e-3) << delay;
        EXPECT_NEAR(fixture->stiffness_N_per_m(), 9000, 1) << delay;
        EXPECT_NEAR(result.last().position_m, 5.0 / 9500, 1e-4) << delay;
        EXPECT_GE(result.least_J, -12 * 0.02 * 1.0) << delay;
    }
}

struct TwoPorts {
    TwoPortMaster master;
    TwoPortWall wall;
    DelayLine force, energy;
};

std::shared_ptr<TwoPorts> two_ports(const HandCase& hand, std::size_t delay) {
    return std::make_shared<TwoPorts>(TwoPorts{TwoPortMaster({kTick_s, 0}, hand.mass_kg / kTick_s),
                                               TwoPortWall(0, hand.wall_N_per_m, hand.limit_N),
                                               DelayLine(delay), DelayLine(delay)});
}

Controller with_two_ports(const HandCase& hand, const std::shared_ptr<TwoPorts>& ports) {
    return [hand, ports](double x_m, double force_held_N) {
        ports->master.observe(x_m, force_held_N);
        const double force_N = ports->wall.force_N(x_m, ports->master.energy_in_J());
        const double told_J = ports->energy.pass(ports->wall.energy_in_J());
        return std::clamp(ports->master.force_N(ports->force.pass(force_N), told_J), -hand.limit_N,
                          hand.limit_N);
    };
}

// Passive, and of no use before a forbidden region: the hand is inside, the proxy has been led out, and nothing pushes. With longer
// delays a force can be left, and the hand is as far from the proxy.
TEST(TwoPort, TheProxyDriftsOutOfTheWall) {
    HandCase light;
    light.mass_kg = 0.35, light.damping_Ns_per_m = 6, light.stiffness_N_per_m = 400;
    for (const std::size_t delay : {10U, 50U, 100U, 200U}) {
        SCOPED_TRACE(delay);
        const auto ports = two_ports(light, delay);
        const LoopResult result = run_loop(light, with_two_ports(light, ports), 8000);
        EXPECT_GT(result.last().position_m - ports->wall.position_proxy_m(), 2e-3);
        if (delay > 50) continue;
        EXPECT_LT(result.swing_m(), 0.1e-3);
        EXPECT_GT(result.last().position_m, 9e-3);
        EXPECT_LE(ports->wall.position_proxy_m(), 1e-6);
        EXPECT_EQ(result.last().force_N, 0);
    }
}

TEST(TwoPort, WithoutDelayTheProxyStaysWithTheHand) {
    const HandCase firm;
    const auto ports = two_ports(firm, 0);
    const LoopResult result = run_loop(firm, with_two_ports(firm, ports), 8000);
    EXPECT_GT(result.last().force_N, 3);
    EXPECT_LT(result.swing_m(), 0.2e-3);
}

// For any motion, any force, and reported energies that are lost or late: the slave's end gives out no more energy
// than was reported to it.
TEST(TwoPort, TheSlaveLetsOutNoMoreThanItHasHeardOf) {
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
    };
    for (int run = 0; run < 50; ++run) {
        TwoPortSlave slave;
        double hand_m = 0, told_J = 0, told_most_J = 0, sent_J = 0, before_m = slave.move(0, 0, 0), out_J = 0,
               reach_N = 0;
        for (int k = 0; k < 2000; ++k) {
            hand_m += uniform(-1e-3, 1e-3);
            sent_J += uniform(0, 1e-3);
            if (uniform(0, 1) < 0.3) told_J = sent_J * uniform(0, 1);  // late, or an older one after a newer
            told_most_J = std::max(told_most_J, told_J);
            // Adversarial at times: as hard as can be while the hand comes.
            const double force_N = run % 2 == 0 ? uniform(0.01, 12) : (k / 50 % 2 == 0 ? 12 : 0.01);
            const double after_m = slave.move(hand_m, force_N, told_J);
            out_J += force_N * (after_m - before_m);
            before_m = after_m;
            ASSERT_LE(out_J, told_most_J + 1e-9) << run << ' ' << k;
            reach_N = std::max(reach_N, force_N);
        }
        EXPECT_GT(reach_N, 11);
        EXPECT_GE(slave.energy_in_J(), 0);
    }
}

// 5 N push out over 1 mm, twice, unpaid: the damper takes each 5 mJ. Its own force is none that the network sends, and its energy did
// not go into the network: reported to the slave, it would come out there.
TEST(TwoPort, TheMastersDamperFeedsNobodyAndIsNoForceOfTheNetwork) {
    TwoPortMaster master({kTick_s, 0}, 1000);
    master.observe(0, 0);
    master.observe(-1e-3, 5);
    const double force_N = master.force_N(5, 0);
    EXPECT_NEAR(force_N, 0, 1e-12);
    EXPECT_EQ(master.force_N(5, 0), force_N);  // asked twice in a sample it is one damper
    const double before_J = master.energy_in_J();
    master.observe(-2e-3, force_N);
    EXPECT_EQ(master.energy_in_J(), before_J);
    EXPECT_NEAR(master.force_N(5, 0), 0, 1e-12);
}

TEST(TwoPort, AReadingThatIsNoNumberIsNoSample) {
    TwoPortMaster master({kTick_s, 0}, 1000);
    master.observe(0, 0);
    master.observe(std::nan(""), 5);
    master.observe(1e-3, std::nan(""));
    EXPECT_EQ(master.energy_in_J(), 0);
    master.observe(1e-3, 5);
    EXPECT_DOUBLE_EQ(master.energy_in_J(), 5e-3);
}

// It may go back by so much at a time; what is owed stays owed.
TEST(TwoPort, ACorrectionIsLimitedAndGoesOn) {
    TwoPortSlave slave(1e-4);
    slave.move(0, 0, 0);
    double proxy_m = slave.move(1e-3, 5, 0);
    EXPECT_NEAR(proxy_m, 0.9e-3, 1e-12);
    for (int i = 0; i < 9; ++i) proxy_m = slave.move(1e-3, 5, 0);
    EXPECT_NEAR(proxy_m, 0, 1e-12);
    EXPECT_NEAR(slave.move(1e-3, 5, 0), 0, 1e-12);
}

}  // namespace
}  // namespace thimble::test
