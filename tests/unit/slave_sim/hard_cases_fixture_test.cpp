// Fixtures of 1e6 and 1e9 N/m: forces to the rounding of one product, times of contact to that of one
// quotient, however stiff.
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "slave_sim/elements/forbidden_region.hpp"

namespace thimble {
namespace {

using Events = std::vector<std::pair<double, std::string>>;

class HardFixture : public testing::TestWithParam<double> {
  protected:
    ForbiddenRegion make(double damping_Ns_per_m, double position_m = 0.125) const {
        return ForbiddenRegion({GetParam(), damping_Ns_per_m, position_m, {}});
    }
};
INSTANTIATE_TEST_SUITE_P(Stiffness, HardFixture, testing::Values(3000.0, 1e6, 1e9));

struct Stepped {
    double force_N;
    Events events;
};

Stepped step(ForbiddenRegion& fixture, double from_m, double to_m, double duration_s) {
    Transitions transitions;
    fixture.step({0, duration_s, from_m, to_m, (to_m - from_m) / duration_s}, transitions);
    Stepped result{fixture.force_N(), {}};
    for (const Transition& t : transitions) result.events.emplace_back(t.offset_s, t.phase);
    return result;
}

TEST_P(HardFixture, NeedleAtRestOnTheFixtureFeelsNothing) {
    ForbiddenRegion fixture = make(100);
    fixture.reset(0.125);
    for (int i = 0; i < 3; ++i) {
        const Stepped s = step(fixture, 0.125, 0.125, 0.001);
        EXPECT_EQ(s.force_N, 0);
        EXPECT_EQ(s.events, Events{});
    }
    // Up to the plane and back is no contact either.
    EXPECT_EQ(step(fixture, 0.125, 0.0625, 1).events, Events{});
    EXPECT_EQ(step(fixture, 0.0625, 0.125, 1).events, Events{});
    EXPECT_EQ(fixture.touch(0.125).penetration_m, 0);
    EXPECT_EQ(fixture.rests_above_m(), 0.125);
}

// The next double beyond the plane is beyond it.
TEST_P(HardFixture, OneUlpBeyondIsContact) {
    ForbiddenRegion fixture = make(0);
    fixture.reset(0.125);
    const double beyond_m = std::nextafter(0.125, 1.0);
    const Stepped s = step(fixture, 0.125, beyond_m, 0.001);
    EXPECT_EQ(s.events, (Events{{0, "touched"}}));
    EXPECT_EQ(s.force_N, -GetParam() * (beyond_m - 0.125));
    EXPECT_EQ(step(fixture, beyond_m, 0.125, 0.001).events, (Events{{0.001, "left"}}));
}

// Where the needle is within a factor of two of the plane their difference is exact, so the force carries the
// rounding of one product.
TEST_P(HardFixture, ForceIsRoundedOnce) {
    const ForbiddenRegion fixture = make(0, 0.123);
    const double position_m = 0.123;
    for (int i = 1; i < 2000; ++i) {
        const double needle_m = position_m + 1.7e-9 * i * i;
        const double stiffness = GetParam();
        // The product and its rounding error, both exact.
        const double product = stiffness * (needle_m - position_m);
        const double error = std::fma(stiffness, needle_m - position_m, -product);
        EXPECT_LE(std::abs(error), 0.5 * (std::nextafter(product, 1e300) - product));
        ASSERT_EQ(fixture.touch(needle_m).force_N, -product);
    }
}

TEST_P(HardFixture, TouchedAndLeftToTheBit) {
    ForbiddenRegion fixture = make(0);
    fixture.reset(0);
    EXPECT_EQ(step(fixture, 0, 0.5, 2).events, (Events{{0.5, "touched"}}));
    EXPECT_EQ(fixture.force_N(), -GetParam() * 0.375);
    EXPECT_EQ(step(fixture, 0.5, 0, 2).events, (Events{{1.5, "left"}}));
    EXPECT_EQ(fixture.force_N(), 0);
}

// B of 1e9 N s/m and a metre in 1e-7 s: 1e16 N, and still a number; out again the damper never pulls.
TEST_P(HardFixture, DampingNeitherOverflowsNorPulls) {
    ForbiddenRegion fixture = make(1e9);
    fixture.reset(0);
    const Stepped in = step(fixture, 0, 1, 1e-7);
    EXPECT_NEAR(in.force_N / -(GetParam() * 0.875 + 1e16), 1, 1e-15);
    const Stepped out = step(fixture, 1, 0.25, 1e-7);
    EXPECT_EQ(out.force_N, 0);
    EXPECT_EQ(out.events, Events{});  // no force, but still beyond the plane
    EXPECT_EQ(step(fixture, 0.25, 0, 1).events, (Events{{0.5, "left"}}));
}

// Work done on the spring along piecewise straight paths that end where they began: the trapezoid between the
// crossing and the samples is exact, so what remains is rounding.
TEST_P(HardFixture, SpringGivesBackWhatItTook) {
    ForbiddenRegion fixture = make(0);
    fixture.reset(0);
    double needle_m = 0;
    double before_N = 0;
    double work_J = 0;
    double moved_J = 0;
    for (int i = 1; i <= 20000; ++i) {
        const double to_m = i == 20000 ? 0 : 0.125 + 0.002 * std::sin(0.37 * i) * std::cos(0.011 * i);
        const double force_N = step(fixture, needle_m, to_m, 0.001).force_N;
        const double from_m = needle_m > 0.125 ? needle_m : std::min(0.125, to_m);
        const double end_m = to_m > 0.125 ? to_m : std::min(0.125, needle_m);
        const double part_J =
            -0.5 * (before_N + force_N) * (std::max(end_m, 0.125) - std::max(from_m, 0.125));
        work_J += part_J;
        moved_J += std::abs(part_J);
        needle_m = to_m;
        before_N = force_N;
    }
    EXPECT_GT(moved_J, 1e-4 * GetParam() * 0.002);
    EXPECT_LE(std::abs(work_J), 1e-13 * moved_J);
}

// With damping the loop costs work: B v^2 t and more, as long as the damper may pull less than the spring
// pushes.
TEST_P(HardFixture, DampingTakesWork) {
    const double damping = GetParam() / 1000;
    ForbiddenRegion fixture = make(damping);
    fixture.reset(0.125);
    double work_J = 0;
    double needle_m = 0.125;
    constexpr int kSteps = 1000;
    for (int i = 1; i <= 2 * kSteps; ++i) {
        const double to_m = 0.125 + 0.001 * (i <= kSteps ? i : 2 * kSteps - i) / kSteps;
        const double v = (to_m - needle_m) / 0.001;
        const double first_N = fixture.touch(needle_m, v).force_N;
        work_J -= 0.5 * (first_N + step(fixture, needle_m, to_m, 0.001).force_N) * (to_m - needle_m);
        needle_m = to_m;
    }
    // |v| = 1 mm/s for 2 s. In the last micrometre before the plane the damper would pull, and in the first
    // sample at the plane the reported force is that of no contact: of 2000 steps, two at most differ.
    EXPECT_NEAR(work_J / (damping * 1e-6 * 2), 1, 2e-3);
}

}  // namespace
}  // namespace thimble
