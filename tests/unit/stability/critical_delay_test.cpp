// The critical delay against figures computed twice at 50 digits (the project's stability study), and against bounds.
#include "stability/critical_delay.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

struct Case {
    HeldMass held;
    double loop_N_per_m, critical_s;
};

TEST(CriticalDelay, OfAHeldMassAtFullPrecision) {
    const std::vector<Case> cases{
        {{0.15, 3, 300}, 9000, 3.337159590934331e-4},    {{0.15, 3, 300}, 3000, 1.003666214279662e-3},
        {{0.35, 6, 400}, 9000, 6.679924804963926e-4},    {{0.35, 6, 400}, 3000, 2.012955941734541e-3},
        {{0.55, 6.45, 135}, 9000, 7.176852265458042e-4}, {{0.55, 6.45, 135}, 3000, 2.159434024119764e-3},
        {{1, 20, 500}, 9000, 2.239576310403288e-3},      {{1, 20, 500}, 3000, 6.839906484520096e-3},
        {{2, 40, 1000}, 9000, 4.51757022253208e-3},      {{2, 40, 1000}, 3000, 1.414198376537471e-2}};
    for (const Case& c : cases) {
        EXPECT_NEAR(critical_delay_s(c.held, c.loop_N_per_m) / c.critical_s, 1, 1e-12);
        EXPECT_GE(critical_delay_s(c.held, c.loop_N_per_m), c.held.damping_Ns_per_m / c.loop_N_per_m);
    }
}

// Five-parameter hands: grip and arm move apart at the loop's frequency.
TEST(CriticalDelay, OfAHandleInAHand) {
    const double cases[][3]{{0.5, 3000, 0.000560062147852525},
                            {0.5, 9000, 0.0001552599995853973},
                            {5, 3000, 0.002084423044327223},
                            {5, 9000, 0.0006570937247204992}};
    for (const auto& [handle_damping, loop, critical_s] : cases) {
        const HeldHandle hand{0.25, handle_damping, 380, 0.8, 0.2, 4.6, 79};
        EXPECT_NEAR(critical_delay_s(hand, loop) / critical_s, 1, 1e-10);
    }
}

// Below K_di = b sqrt(4mk - b^2) / (2m) no delay makes it unstable.
TEST(CriticalDelay, SoftFixturesBearAnyDelay) {
    const HeldMass light{0.15, 3, 300};
    EXPECT_TRUE(std::isinf(critical_delay_s(light, 130.7)));
    EXPECT_FALSE(std::isinf(critical_delay_s(light, 130.8)));
    EXPECT_TRUE(std::isinf(critical_delay_s(HeldMass{1, 100, 500}, 499)));  // overdamped
}

// Handle and arm as one where the grip is stiff enough.
TEST(CriticalDelay, AStiffGripJoinsHandleAndArm) {
    const HeldHandle glued{0.25, 1, 1e9, 1e5, 0.75, 19, 500};
    EXPECT_NEAR(critical_delay_s(glued, 9000), critical_delay_s(HeldMass{1, 20, 500}, 9000), 1e-6);
}

TEST(CriticalDelay, StifferFixturesBearLess) {
    const HeldHandle nominal{0.25, 1, 1000, 19, 1.2, 18, 350};
    double last_s = 1;
    for (const double loop : {3000.0, 9000.0, 27000.0}) {
        EXPECT_LT(critical_delay_s(nominal, loop), last_s);
        last_s = critical_delay_s(nominal, loop);
        EXPECT_GT(last_s, 1 / loop);  // the handle's own damping at the least
    }
}

}  // namespace
}  // namespace thimble
