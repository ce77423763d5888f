#include "slave_sim/elements/forbidden_region.hpp"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(ForbiddenRegion, PushesBackWhatIsBeyondIt) {
    const ForbiddenRegion fixture({3000, 0, 0.123, {}});
    const FixtureContact c = fixture.touch(0.124);
    EXPECT_EQ(c.position_proxy_m, 0.123);
    EXPECT_NEAR(c.penetration_m, 0.001, 1e-17);
    EXPECT_NEAR(c.force_N, -3, 1e-12);
}

TEST(ForbiddenRegion, LetsTheNeedleComeUpToIt) {
    const ForbiddenRegion fixture({3000, 0, 0.123, {}});
    for (const double needle_m : {-1.0, 0.0, 0.1229, 0.123}) {
        const FixtureContact c = fixture.touch(needle_m);
        EXPECT_EQ(c.position_proxy_m, needle_m);
        EXPECT_EQ(c.penetration_m, 0);
        EXPECT_EQ(c.force_N, 0);
    }
}

TEST(ForbiddenRegion, AbsentItIsNotFelt) {
    ForbiddenRegion fixture({3000, 0, 0.123, {}});
    fixture.place(0.123, false, 0);
    EXPECT_FALSE(fixture.present());
    EXPECT_EQ(fixture.touch(0.2).force_N, 0);
    EXPECT_EQ(fixture.touch(0.2).penetration_m, 0);
    EXPECT_EQ(fixture.touch(0.2).position_proxy_m, 0.2);
}

TEST(ForbiddenRegion, MovesWhereItIsPut) {
    ForbiddenRegion fixture({3000, 0, 0.123, {}});
    fixture.place(0.1, true, 0);
    EXPECT_EQ(fixture.position_m(), 0.1);
    EXPECT_NEAR(fixture.touch(0.123).force_N, -69, 1e-10);
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

TEST(ForbiddenRegion, EachTrialHasItsChanges) {
    FixtureChange removal;
    removal.time_s = 0.0005;
    FixtureWalker w(with_change(removal), 0.501);
    for (int trial = 0; trial < 2; ++trial) {
        w.fixture.reset(0.501);
        w.time_s = 0;
        EXPECT_TRUE(w.fixture.present());
        w.to(0.501, 0.001);
        EXPECT_FALSE(w.fixture.present()) << trial;
    }
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

TEST(ForbiddenRegion, ResetBringsBackWhatWasPlaced) {
    FixtureWalker w(with_change({1.0, {}, false, {}}), 0.75);
    w.to(0.75, 2);
    EXPECT_FALSE(w.fixture.present());
    w.fixture.reset(0.75);
    EXPECT_TRUE(w.fixture.present());
    EXPECT_NEAR(w.fixture.force_N(), -750, 1e-9);
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
