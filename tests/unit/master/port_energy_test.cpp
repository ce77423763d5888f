// The passivity observer of the handle: what goes in, what comes out.
#include "master/port_energy.hpp"

#include <cmath>
#include <deque>
#include <numbers>

#include <gtest/gtest.h>

namespace thimble::test {
namespace {

constexpr double kSpring_N_per_m = 1000;
constexpr double kAmplitude_m = 0.005;

// A hand that goes in and out sinusoidally against a spring felt `delay` samples late; work per cycle of 1000 samples.
double work_of_cycles_J(int cycles, std::size_t delay) {
    PortEnergy energy;
    std::deque<double> forces_N(delay, 0.0);
    for (int i = 0; i <= 1000 * cycles; ++i) {
        const double x_m = kAmplitude_m * (1 - std::cos(2 * std::numbers::pi * i / 1000.0));
        forces_N.push_back(kSpring_N_per_m * x_m);
        energy.add({x_m, forces_N.front()});
        forces_N.pop_front();
    }
    return energy.energy_in_J();
}

TEST(PortEnergy, TheFirstSampleOnlyPlacesTheHandle) {
    PortEnergy energy;
    energy.add({0.02, 5});
    EXPECT_EQ(energy.energy_in_J(), 0);
    EXPECT_EQ(energy.force_hand_N(), 5);
}

TEST(PortEnergy, PushingInAgainstAForceIsWork) {
    PortEnergy energy;
    energy.add({0, 2});
    energy.add({0.01, 2});
    EXPECT_DOUBLE_EQ(energy.energy_in_J(), 0.02);
    energy.add({0, 2});  // and is given back
    EXPECT_DOUBLE_EQ(energy.energy_in_J(), 0);
    energy.add({0, 7});  // a force that moves nothing does no work
    EXPECT_DOUBLE_EQ(energy.energy_in_J(), 0);
}

TEST(PortEnergy, ClearBeginsAnew) {
    PortEnergy energy;
    energy.add({0, 2});
    energy.add({0.01, 2});
    energy.clear();
    energy.add({0.5, 2});
    EXPECT_EQ(energy.energy_in_J(), 0);
}

// Half a cycle stores k X^2 / 2, X = 2 A; a whole one gives it back, but for the sums' own h x v^2.
TEST(PortEnergy, ASpringGivesBackWhatItGot) {
    const double stored_J = kSpring_N_per_m * 4 * kAmplitude_m * kAmplitude_m / 2;
    EXPECT_NEAR(work_of_cycles_J(10, 0) / (10 * stored_J), 0, 0.02);
}

// F = k x(t - T) against x = A (1 - cos wt): E per cycle = -pi k A^2 sin wT.
TEST(PortEnergy, ADelayedSpringGivesOutMore) {
    for (const std::size_t delay : {20U, 50U, 100U}) {
        const double phase = 2 * std::numbers::pi * (static_cast<double>(delay) - 0.5) / 1000;
        const double expected_J =
            -std::numbers::pi * kSpring_N_per_m * kAmplitude_m * kAmplitude_m * std::sin(phase);
        const double settled_J = work_of_cycles_J(11, delay) - work_of_cycles_J(1, delay);
        EXPECT_NEAR(settled_J / (10 * expected_J), 1, 0.02) << delay;
    }
}

}  // namespace
}  // namespace thimble::test
