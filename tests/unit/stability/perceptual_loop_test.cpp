// The person's own loop, measured against its theory.
#include "stability/perceptual_loop.hpp"

#include "common/error.hpp"
#include "tests/unit/stability/golden_loops.hpp"

namespace thimble {
namespace {

constexpr HeldMass kGrip{1, 20, 500};

TEST(PerceptualLoop, AsMeasuredItEndsWhereTheoryAndTheStabilityStudySay) {
    for (const auto& c : golden_loops("perceptual_loop")) {
        const double limit = figure(c, "L_star"), lag_s = figure(c, "tau");
        EXPECT_LT(measured_perceptual_growth_per_s(hand_of(c), lag_s, 0.98 * limit), 0) << c.dump();
        EXPECT_GT(measured_perceptual_growth_per_s(hand_of(c), lag_s, 1.02 * limit), 0) << c.dump();
    }
    const double theory = perceptual_limit(kGrip, 0.245).gain_per_s;
    expect_relative(measured_perceptual_limit_per_s(kGrip, 0.245, 1e-4), theory, 1e-3, "firm grip");
}

TEST(PerceptualLoop, WhoWaitsForTheOutcomeBearsTwiceTheErrorAtAnyLag) {
    for (const double lag_s : {0.1, 0.4, 1.5}) {
        const PausedCorrection waits{lag_s, lag_s + 1.2, 0.2};
        EXPECT_DOUBLE_EQ(paused_limit(waits), 2);
        expect_relative(measured_paused_limit(kGrip, waits, 1e-3), 2, 0.01, "waits");
    }
}

TEST(PerceptualLoop, WhoDoesNotWaitBearsLess) {
    // One move old: 2 sin(pi / 6); two: 2 sin(pi / 10).
    for (const auto& [lag_s, limit] : {std::pair{1.5, 1.0}, std::pair{3.0, 0.6180339887498949}}) {
        const PausedCorrection hurries{lag_s, 1.5, 0.2};
        expect_relative(paused_limit(hurries), limit, 1e-12, "theory");
        expect_relative(measured_paused_limit(kGrip, hurries, 1e-3), limit, 0.02, "measured");
    }
}

TEST(PerceptualLoop, WhatIsNoLoopIsRefused) {
    EXPECT_THROW(measured_perceptual_growth_per_s(kGrip, 0, 1), Error);
    EXPECT_THROW(measured_perceptual_growth_per_s({1, 0, 500}, 0.2, 1), Error);
    EXPECT_THROW(paused_limit({0.1, 0.2, 0.3}), Error);
    EXPECT_THROW(paused_limit({0, 0.2, 0.1}), Error);
    EXPECT_THROW(paused_limit({std::nan(""), 0.2, 0.1}), Error);
}

}  // namespace
}  // namespace thimble
