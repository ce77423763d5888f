// The bounds' promise, for motions and wanted forces of all kinds: the work of the hand, with the device's damping, never falls below
// zero.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "common/control/energy_bound.hpp"
#include "common/control/passivity_controller.hpp"
#include "common/control/port_observer.hpp"
#include "common/random.hpp"

namespace thimble {
namespace {

constexpr double kTickProof_s = 1e-3;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

RandomStream draws(std::uint32_t run) { return RandomStream({77, 9, run, 0, Purpose::kParameter}); }

// A hand that knows the force. kWorst takes out all that can be taken in one tick.
enum class Motion { kRandom, kAway, kWorst, kSine };
constexpr std::array kMotions{Motion::kRandom, Motion::kAway, Motion::kWorst, Motion::kSine};

double travel_m(Motion motion, double force_N, double damping_Ns_per_m, int tick, RandomStream& random) {
    switch (motion) {
        case Motion::kRandom:
            return 1e-3 * random.normal();
        case Motion::kAway:
            return random.uniform() < 0.5 ? 1e-4 * random.normal() : -2e-6 * force_N;
        case Motion::kWorst:
            return random.uniform() < 0.2 ? 2e-4 * random.normal()
                                          : -force_N * kTickProof_s / (2 * damping_Ns_per_m);
        default:
            return 3e-4 * std::sin(0.05 * tick);
    }
}

// Wishes: noise, a bang against the motion it foresees, nothing that is a number.
double wish_N(int kind, double coming_m, RandomStream& random) {
    if (random.uniform() < 0.01) return kNoNumber;
    if (kind == 0) return random.uniform(-100, 100);
    return coming_m > 0 ? -100 : 100;
}

double least_J(PortCompensator& compensator, Motion motion, int requests, double damping_Ns_per_m, bool gaps,
               RandomStream random) {
    double position_m = 0, force_N = 0, dissipated_J = 0, least = 0;
    PortObserver port;
    compensator.reset();
    for (int tick = 0; tick < 1500; ++tick) {
        port.add(position_m, force_N);
        least = std::min(least, port.energy_in_J() + dissipated_J);
        compensator.observe(kTickProof_s, gaps && random.uniform() < 0.02 ? kNoNumber : position_m, force_N);
        const double guessed_m = travel_m(motion, 1, damping_Ns_per_m, tick, random);
        force_N = compensator.force_N(wish_N(requests, guessed_m, random));
        const double step_m = motion == Motion::kSine || motion == Motion::kRandom
                                  ? guessed_m
                                  : travel_m(motion, force_N, damping_Ns_per_m, tick, random);
        dissipated_J += damping_Ns_per_m * step_m * step_m / kTickProof_s;
        position_m += step_m;
    }
    return least;
}

std::unique_ptr<PortCompensator> bound(int kind, double damping_Ns_per_m) {
    const PortSettings port{kTickProof_s, damping_Ns_per_m};
    if (kind == 0) return std::make_unique<MemorylessBound>(port);
    if (kind == 1) return std::make_unique<LeastConservativeBound>(port);
    return std::make_unique<TwoLayerTank>(port, TankSettings{});
}

TEST(PortProof, BoundsNeverGiveOutMoreThanCameIn) {
    std::uint32_t run = 0;
    for (int kind = 0; kind < 3; ++kind) {
        for (const double damping_Ns_per_m : {0.01, 0.5, 5.0}) {
            for (const Motion motion : kMotions) {
                for (int requests = 0; requests < 2; ++requests) {
                    for (const bool gaps : {false, true}) {
                        const auto compensator = bound(kind, damping_Ns_per_m);
                        EXPECT_GE(
                            least_J(*compensator, motion, requests, damping_Ns_per_m, gaps, draws(++run)),
                            -1e-9)
                            << kind << ' ' << damping_Ns_per_m << ' ' << static_cast<int>(motion) << ' '
                            << requests << ' ' << gaps;
                    }
                }
            }
        }
    }
}

// The same inputs take energy out of a handle that only observes: the test above can fail.
TEST(PortProof, APassivityControllerIsNoBound) {
    PassivityController compensator({kTickProof_s, 0.5}, 250);
    EXPECT_LT(least_J(compensator, Motion::kWorst, 1, 0.5, false, draws(1)), -1e-3);
}

TEST(PortProof, WithoutDeviceDampingOrANumberThereIsNoForce) {
    for (int kind = 0; kind < 3; ++kind) {
        SCOPED_TRACE(kind);
        const auto undamped = bound(kind, 0), compensator = bound(kind, 0.5);
        for (const double position_m : {0.0, 1e-2}) {
            undamped->observe(kTickProof_s, position_m, 0);
            compensator->observe(kTickProof_s, position_m, 0);
        }
        EXPECT_EQ(undamped->force_N(5), 0);
        EXPECT_GT(compensator->force_N(5), 1);
        EXPECT_EQ(compensator->force_N(kNoNumber), compensator->force_N(0));
        compensator->observe(kTickProof_s, kNoNumber, 5);
        EXPECT_EQ(compensator->force_N(5), 0);
        compensator->observe(kNoNumber, 1e-2, 0);
        EXPECT_EQ(compensator->force_N(5), 0);
        compensator->observe(kTickProof_s, 2e-2, 0);
        EXPECT_EQ(compensator->refused(), 3U);
    }
}

// A late sample: the damping had more time for the way, so it took less.
TEST(PortProof, ALateSampleIsCreditedWithLessDamping) {
    LeastConservativeBound in_time({kTickProof_s, 0.5}), late({kTickProof_s, 0.5});
    for (LeastConservativeBound* compensator : {&in_time, &late}) compensator->observe(kTickProof_s, 0, 0);
    in_time.observe(kTickProof_s, 1e-3, 0);
    late.observe(5 * kTickProof_s, 1e-3, 0);
    EXPECT_DOUBLE_EQ(late.energy_J(), in_time.energy_J() / 5);
    late.observe(0.1 * kTickProof_s, 2e-3, 0);  // early: no more than in time
    EXPECT_DOUBLE_EQ(late.energy_J(), in_time.energy_J() * 1.2);
}

}  // namespace
}  // namespace thimble
