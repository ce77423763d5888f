// The first rise of the gap, against a scan in small steps and against hand-made hard cases.
#include "slave_sim/crossing.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/slave_sim/random_values.hpp"

namespace thimble {
namespace {

GapMotion random_gap(const SecondOrder& law) {
    GapMotion gap;
    gap.side = *rc::gen::arbitrary<bool>() ? 1 : -1;
    gap.gap_m = between(-1, 1);
    gap.velocity_needle_m_per_s = between(-0.5, 0.5);
    gap.velocity_surface_m_per_s = between(-3, 3);
    gap.acceleration_surface_m_per_s2 = between(-5, 5);
    gap.law = &law;
    return gap;
}

// Independent of monotone pieces: looks everywhere.
double scan(const GapMotion& gap, double duration_s, int samples) {
    double before = gap.at(0.0).value_m;
    for (int i = 1; i <= samples; ++i) {
        const double value = gap.at(duration_s * i / samples).value_m;
        if (before <= 0 && value > 0) return duration_s * i / samples;
        before = value;
    }
    return kNoCrossing;
}

TEST(Crossing, FindsWhatAScanFindsAndNothingElse) {
    EXPECT_TRUE(rc::check("first rise", [] {
        const SecondOrder law(between(0.1, 3), between(0, 6), between(0, 60));
        GapMotion gap = random_gap(law);
        if (gap.side * gap.gap_m > 0) gap.side = -gap.side;
        const double duration_s = between(0.001, 20);
        const double rise_s = first_rise(gap, duration_s);
        constexpr int kSamples = 4000;
        const double seen_s = scan(gap, duration_s, kSamples);
        RC_CLASSIFY(rise_s >= 0);
        if (seen_s >= 0) {
            RC_ASSERT(rise_s >= 0);
            RC_ASSERT(rise_s <= seen_s * (1 + 1e-15));
        }
        if (rise_s < 0) return;
        RC_ASSERT(rise_s <= duration_s);
        RC_ASSERT(std::abs(gap.at(rise_s).value_m) < 1e-13);
        // Nothing earlier: the scan may miss a short visit above zero, the search may not invent one.
        RC_ASSERT(gap.at(rise_s).rate_m_per_s >= -1e-9);
    }));
}

TEST(Crossing, TheCheapTestNeverHidesARise) {
    EXPECT_TRUE(rc::check("cannot_rise is conservative", [] {
        const SecondOrder law(between(0.1, 3), between(0, 6), between(0, 60));
        GapMotion gap = random_gap(law);
        gap.gap_m *= 0.01;
        const double duration_s = between(0.001, 0.5);
        if (!cannot_rise(gap.at(0.0), gap.at(duration_s), duration_s)) return;
        RC_ASSERT(scan(gap, duration_s, 500) == kNoCrossing);
        RC_ASSERT(first_rise(gap, duration_s) == kNoCrossing);
    }));
}

// Of a needle and a surface under this law, which are this far from each other.
GapMotion gap_of(const SecondOrder& law, double gap_m, double needle_m_per_s, double surface_m_per_s) {
    GapMotion gap;
    gap.gap_m = gap_m;
    gap.velocity_needle_m_per_s = needle_m_per_s;
    gap.velocity_surface_m_per_s = surface_m_per_s;
    gap.law = &law;
    return gap;
}

// gap = 0.25 - (t - 1)^2 / 4 - depth, drawn with a mass that nothing holds.
GapMotion parabola(const SecondOrder& free_mass, double depth_m) {
    GapMotion gap = gap_of(free_mass, -depth_m, 0.5, 0);
    gap.acceleration_surface_m_per_s2 = 0.5;
    return gap;
}

TEST(Crossing, GrazingIsAnEventOnlyIfItPasses) {
    const SecondOrder free_mass(1, 0, 0);
    EXPECT_EQ(first_rise(parabola(free_mass, 0.25 + 1e-9), 5), kNoCrossing);
    EXPECT_EQ(first_rise(parabola(free_mass, 0.25), 5), kNoCrossing);
    // 1e-12 m above for 4e-6 s, in the middle of a step of 5 s.
    EXPECT_NEAR(first_rise(parabola(free_mass, 0.25 - 1e-12), 5), 1 - 2e-6, 1e-9);
    EXPECT_NEAR(first_rise(parabola(free_mass, 0.1875), 5), 0.5, 1e-15);
}

TEST(Crossing, AGapOnTheGuardFiresOnlyIfItRises) {
    const SecondOrder law(1, 5, 2);
    GapMotion gap = gap_of(law, 0, 0, 0);
    EXPECT_EQ(first_rise(gap, 1), kNoCrossing);  // rests
    gap.velocity_needle_m_per_s = -0.1;
    EXPECT_EQ(first_rise(gap, 1), kNoCrossing);  // falls
    gap.velocity_needle_m_per_s = 0.1;
    EXPECT_EQ(first_rise(gap, 1), 0);  // rises
    gap.gap_m = 1e-18;                 // a rounding error late
    EXPECT_EQ(first_rise(gap, 1), 0);
    gap.gap_m = 0;
    gap.side = -1;
    EXPECT_EQ(first_rise(gap, 1), kNoCrossing);
    gap.velocity_needle_m_per_s = 0;
    gap.acceleration_surface_m_per_s2 = 1;
    EXPECT_EQ(first_rise(gap, 1), 0);  // no speed yet, but on its way
}

// Hundreds of half periods in one step; only the late drift of the needle reaches the surface.
TEST(Crossing, SkipsNoOscillationOfALongStep) {
    const SecondOrder spring(1, 0, 1e4);  // 100 rad/s
    // Amplitude 0.2 m: the first touch is where a trough meets the needle.
    const GapMotion gap = gap_of(spring, -1, 0.1, 20);
    const double rise_s = first_rise(gap, 100);
    EXPECT_NEAR(rise_s, scan(gap, 10, 2000000), 1e-5);
    EXPECT_NEAR(gap.at(rise_s).value_m, 0, 1e-12);
}

// 3e8 swings before the needle comes within reach at t = 1 s, and 3e8 after it in which it never would: both
// are passed over. Within reach it is met in the next swing.
TEST(Crossing, PassesOverSwingsThatCannotReachTheNeedle) {
    const SecondOrder spring(1e-12, 0, 4e6);             // 2e9 rad/s
    GapMotion gap = gap_of(spring, -1e-3, 0.9e-3, 2e5);  // amplitude 1e-4 m
    EXPECT_EQ(first_rise(gap, 0.999999), kNoCrossing);
    EXPECT_NEAR(first_rise(gap, 2), 1, 1e-6);
    gap.velocity_needle_m_per_s = 0;
    EXPECT_EQ(first_rise(gap, 1e9), kNoCrossing);
    gap.velocity_needle_m_per_s = 1e-13;  // within reach after 1e10 s: no phase is left, but it ends
    EXPECT_GE(first_rise(gap, 2e10), 0.89e10);
}

TEST(Crossing, ALongStepOfADampedSurfaceEndsSoon) {
    const SecondOrder law(1e-6, 1e-3, 1e6);  // a million rad/s, gone after a few milliseconds
    const GapMotion gap = gap_of(law, -1, 0, 1);
    EXPECT_EQ(first_rise(gap, 1e6), kNoCrossing);  // 3e11 half periods: would never end if walked
}

}  // namespace
}  // namespace thimble
