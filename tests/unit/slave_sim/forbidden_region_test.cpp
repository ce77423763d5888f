#include "slave_sim/elements/forbidden_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(ForbiddenRegion, PushesBackWhatIsBeyondItWhereItIsPut) {
    struct Place {
        double plane_m;
        bool present;
        double needle_m, proxy_m, penetration_m, force_N;
    };
    for (const Place& p : {Place{0.123, true, 0.124, 0.123, 0.001, -3},
                           {0.123, true, -1, -1, 0, 0},  // up to the plane
                           {0.123, true, 0.1229, 0.1229, 0, 0},
                           {0.123, true, 0.123, 0.123, 0, 0},
                           {0.123, false, 0.2, 0.2, 0, 0},
                           {0.1, true, 0.123, 0.1, 0.023, -69}}) {
        ForbiddenRegion fixture({3000, 0, 0.123, {}});
        fixture.place(p.plane_m, p.present, 0);
        EXPECT_EQ(fixture.present(), p.present);
        EXPECT_EQ(fixture.position_m(), p.plane_m);
        const FixtureContact c = fixture.touch(p.needle_m);
        EXPECT_EQ(c.position_proxy_m, p.proxy_m);
        EXPECT_NEAR(c.penetration_m, p.penetration_m, 1e-17) << p.needle_m;
        EXPECT_NEAR(c.force_N, p.force_N, 1e-10);
    }
}

using Events = std::vector<std::pair<double, std::string>>;

// Steps from where the needle is; collects what changes.
struct FixtureWalker {
    ForbiddenRegion fixture;
    double time_s = 0;
    double needle_m;
    Transitions transitions{64};
    Events events{};

    FixtureWalker(const FixtureParameters& parameters, double start_m)
        : fixture(parameters), needle_m(start_m) {
        fixture.reset(start_m);
    }
    void to(double position_m, double duration_s) {
        transitions.clear();
        fixture.step({time_s, duration_s, needle_m, position_m, (position_m - needle_m) / duration_s},
                     transitions);
        for (const Transition& t : transitions) events.emplace_back(time_s + t.offset_s, t.phase);
        needle_m = position_m;
        time_s += duration_s;
    }
};

FixtureParameters with_change(const FixtureChange& change) {
    FixtureParameters p;
    p.position_m = 0.5;
    p.changes = {change};
    return p;
}

TEST(ForbiddenRegion, AChangeAtAStepsEndBelongsToTheNextStep) {
    FixtureChange removal;
    removal.time_s = 0.001;
    FixtureWalker w(with_change(removal), 0.501);
    w.to(0.501, 0.001);
    EXPECT_TRUE(w.fixture.present());
    EXPECT_NEAR(w.fixture.touch(0.501).force_N, -3, 1e-9);
    w.to(0.501, 0.001);
    EXPECT_FALSE(w.fixture.present());
}

TEST(ForbiddenRegion, DampingResistsButNeverPulls) {
    FixtureWalker w({1000, 100, 0.5, {}}, 0.5);
    w.to(0.51, 0.1);
    EXPECT_NEAR(w.fixture.force_N(), -(1000 * 0.01 + 100 * 0.1), 1e-9);
    w.to(0.505, 0.1);
    EXPECT_NEAR(w.fixture.force_N(), -(1000 * 0.005 - 100 * 0.05), 1e-9);
    w.to(0.501, 0.001);  // 4 m/s outwards: spring 1 N, damper would pull with 400 N
    EXPECT_EQ(w.fixture.force_N(), 0);
}

struct Way {
    double to_m, duration_s;
};
struct ChangeCase {
    const char* what;
    double plane_m;
    std::vector<FixtureChange> changes;
    double start_m;
    std::vector<Way> ways;
    Events events;
    double force_N;  // at the end, of 3000 N/m
};

TEST(ForbiddenRegion, EventsComeWhenTheyAreDue) {
    const std::vector<ChangeCase> cases{
        {"touched and left where the line crosses",
         0.5,
         {},
         0.25,
         {{0.75, 2}, {0.5, 1}, {0.25, 1}},
         {{1, "touched"}, {3, "left"}},
         0},
        {"vanishes after unbroken contact",
         0.5,
         {{{}, 5.0, false, {}}},
         0.25,
         {{0.75, 1}, {0.75, 4}, {0.75, 1}},
         {{0.5, "touched"}, {5.5, "removed"}, {5.5, "left"}},
         0},
        {"a break starts the contact anew; it comes first where the time is over just then",
         0.5,
         {{{}, 2.0, false, {}}},
         0.5,
         {{0.75, 1.5}, {0.25, 1}, {0.75, 1}, {0.75, 3}},
         {{0, "touched"}, {2, "left"}, {3, "touched"}, {5, "removed"}, {5, "left"}},
         0},
        {"a time comes whether or not the needle is near",
         0.5,
         {{1.5, {}, true, 0.125}},
         0.25,
         {{0.25, 1}, {0.25, 1}},
         {{1.5, "moved"}, {1.5, "touched"}},
         -375},
        {"changes wait for the one before",
         0.5,
         {{2.0, {}, false, {}}, {1.0, {}, true, {}}},
         0.75,
         {{0.75, 1.5}, {0.75, 1.5}},
         {{0, "touched"}, {2, "removed"}, {2, "left"}, {2, "placed"}, {2, "touched"}},
         -750},
        {"the plane jumps inwards past a needle that goes inwards: contact ends then, not with the step",
         0.375,
         {{0.5, {}, true, 0.875}},
         0.25,
         {{0.75, 1}},
         {{0.25, "touched"}, {0.5, "moved"}, {0.5, "left"}},
         0},
        {"it jumps outwards past a needle that retreats but does not reach it",
         0.875,
         {{0.25, {}, true, 0.25}},
         0.75,
         {{0.5, 1}},
         {{0.25, "moved"}, {0.25, "touched"}},
         -750},
        {"a contact wholly within the step: where the needle ends says nothing about it",
         0.875,
         {{0.25, {}, true, 0.5}},
         0.75,
         {{0.25, 1}},
         {{0.25, "moved"}, {0.25, "touched"}, {0.5, "left"}},
         0}};
    for (const ChangeCase& c : cases) {
        SCOPED_TRACE(c.what);
        FixtureWalker w({3000, 0, c.plane_m, c.changes}, c.start_m);
        for (const Way& way : c.ways) w.to(way.to_m, way.duration_s);
        EXPECT_EQ(w.events, c.events);
        EXPECT_NEAR(w.fixture.force_N(), c.force_N, 1e-9);
    }
}

// However stiff: forces to the rounding of one product, times to that of one quotient.
class HardFixture : public testing::TestWithParam<double> {
  protected:
    FixtureWalker walk(double damping_Ns_per_m, double start_m) const {
        return {{GetParam(), damping_Ns_per_m, 0.125, {}}, start_m};
    }
};
INSTANTIATE_TEST_SUITE_P(Stiffness, HardFixture, testing::Values(3000.0, 1e6, 1e9));

// The plane itself is free; the next double beyond it is beyond it.
TEST_P(HardFixture, OneUlpBeyondIsContact) {
    FixtureWalker w = walk(100, 0.125);
    w.to(0.125, 0.001);
    w.to(0.0625, 1);  // and up to the plane again
    w.to(0.125, 1);
    EXPECT_EQ(w.fixture.force_N(), 0);
    EXPECT_EQ(w.fixture.touch(0.125).penetration_m, 0);
    EXPECT_EQ(w.fixture.rests_above_m(), 0.125);
    EXPECT_EQ(w.events, Events{});
    w = walk(0, 0.125);
    const double beyond_m = std::nextafter(0.125, 1.0);
    w.to(beyond_m, 0.001);
    EXPECT_EQ(w.fixture.force_N(), -GetParam() * (beyond_m - 0.125));
    w.to(0.125, 0.001);
    EXPECT_EQ(w.events, (Events{{0, "touched"}, {0.002, "left"}}));
}

// Where the needle is within a factor of two of the plane their difference is exact, so the force carries the
// rounding of one product.
TEST_P(HardFixture, ForceIsRoundedOnce) {
    const double position_m = 0.123;
    const ForbiddenRegion fixture({GetParam(), 0, position_m, {}});
    for (int i = 1; i < 2000; ++i) {
        const double needle_m = position_m + 1.7e-9 * i * i;
        ASSERT_EQ(fixture.touch(needle_m).force_N, -(GetParam() * (needle_m - position_m)));
    }
}

// B of 1e9 N s/m and a metre in 1e-7 s: 1e16 N, and still a number; out again the damper never pulls.
TEST_P(HardFixture, DampingNeitherOverflowsNorPulls) {
    FixtureWalker w = walk(1e9, 0);
    w.to(1, 1e-7);
    EXPECT_NEAR(w.fixture.force_N() / -(GetParam() * 0.875 + 1e16), 1, 1e-15);
    w.to(0.25, 1e-7);
    EXPECT_EQ(w.fixture.force_N(), 0);
    EXPECT_EQ(w.events.size(), 1u) << "no force, but still beyond the plane";
}

// Work done on the spring along piecewise straight paths that end where they began: the trapezoid between the
// crossing and the samples is exact, so what remains is rounding.
TEST_P(HardFixture, SpringGivesBackWhatItTook) {
    FixtureWalker w = walk(0, 0);
    double before_N = 0;
    double work_J = 0;
    double moved_J = 0;
    for (int i = 1; i <= 20000; ++i) {
        const double from_m = std::max(w.needle_m, 0.125);
        w.to(i == 20000 ? 0 : 0.125 + 0.002 * std::sin(0.37 * i) * std::cos(0.011 * i), 0.001);
        const double part_J =
            -0.5 * (before_N + w.fixture.force_N()) * (std::max(w.needle_m, 0.125) - from_m);
        work_J += part_J;
        moved_J += std::abs(part_J);
        before_N = w.fixture.force_N();
    }
    EXPECT_GT(moved_J, 1e-4 * GetParam() * 0.002);
    EXPECT_LE(std::abs(work_J), 1e-13 * moved_J);
}

TEST(ForbiddenRegion, EachTrialHasItsChanges) {
    FixtureWalker w(with_change({1.0, {}, false, {}}), 0.75);
    for (int trial = 0; trial < 2; ++trial) {
        w.fixture.reset(0.75);
        w.time_s = 0;
        EXPECT_TRUE(w.fixture.present());
        EXPECT_NEAR(w.fixture.force_N(), -750, 1e-9);
        w.to(0.75, 2);
        EXPECT_FALSE(w.fixture.present()) << trial;
    }
}

TEST(ForbiddenRegion, SleepsUntilTheNeedleIsThere) {
    FixtureWalker w({3000, 0, 0.5, {}}, 0.25);
    EXPECT_EQ(w.fixture.rests_above_m(), 0.5);
    w.to(0.75, 1);
    EXPECT_EQ(w.fixture.rests_above_m(), -std::numeric_limits<double>::infinity());
    w.to(0.5, 1);
    EXPECT_EQ(w.fixture.rests_above_m(), 0.5);
    w.fixture.place(0.5, false, 0);
    EXPECT_EQ(w.fixture.rests_above_m(), std::numeric_limits<double>::infinity());
    const FixtureWalker timed(with_change({1.5, {}, true, 0.125}), 0.25);
    EXPECT_EQ(timed.fixture.rests_above_m(), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace thimble
