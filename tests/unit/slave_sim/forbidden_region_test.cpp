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

// Steps of 1 ms from where the needle is; collects what changes.
struct FixtureWalker {
    ForbiddenRegion fixture;
    double time_s = 0;
    double needle_m;
    Transitions transitions{64};
    std::vector<std::pair<double, std::string>> events{};

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

TEST(ForbiddenRegion, TouchedAndLeftWhereTheLineCrosses) {
    FixtureWalker w({1000, 0, 0.5, {}}, 0.25);
    w.to(0.75, 2);
    w.to(0.5, 1);
    w.to(0.25, 1);
    ASSERT_EQ(w.events.size(), 2u);
    EXPECT_EQ(w.events[0], std::make_pair(1.0, std::string("touched")));
    EXPECT_EQ(w.events[1], std::make_pair(3.0, std::string("left")));
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

TEST(ForbiddenRegion, VanishesAfterUnbrokenContact) {
    FixtureWalker w(with_change({{}, 5.0, false, {}}), 0.25);
    w.to(0.75, 1);  // touches at 0.5 s
    w.to(0.75, 4);
    EXPECT_LT(w.fixture.force_N(), 0);
    w.to(0.75, 1);  // 5.5 s lies within
    EXPECT_EQ(w.fixture.force_N(), 0);
    EXPECT_FALSE(w.fixture.present());
    ASSERT_EQ(w.events.size(), 3u);
    EXPECT_EQ(w.events[1], std::make_pair(5.5, std::string("removed")));
    EXPECT_EQ(w.events[2], std::make_pair(5.5, std::string("left")));
}

TEST(ForbiddenRegion, ABreakStartsTheContactAnew) {
    FixtureWalker w(with_change({{}, 2.0, false, {}}), 0.5);
    w.to(0.75, 1.5);
    w.to(0.25, 1);  // leaves at 2.0 s, before the 2 s are over... which end at 2.0 s: leaving comes first
    w.to(0.75, 1);
    EXPECT_TRUE(w.fixture.present());
    w.to(0.75, 3);
    EXPECT_FALSE(w.fixture.present());
    EXPECT_EQ(w.events.back().first, 5.0);  // touched again at 3.0 s
}

TEST(ForbiddenRegion, ChangesAtATimeWhetherOrNotTheNeedleIsNear) {
    FixtureWalker w(with_change({1.5, {}, true, 0.125}), 0.25);
    EXPECT_EQ(w.fixture.rests_above_m(), -std::numeric_limits<double>::infinity());
    w.to(0.25, 1);
    EXPECT_EQ(w.fixture.force_N(), 0);
    w.to(0.25, 1);
    EXPECT_NEAR(w.fixture.force_N(), -3000 * 0.125, 1e-9);
    ASSERT_EQ(w.events.size(), 2u);
    EXPECT_EQ(w.events[0], std::make_pair(1.5, std::string("moved")));
    EXPECT_EQ(w.events[1], std::make_pair(1.5, std::string("touched")));
}

TEST(ForbiddenRegion, ChangesWaitForTheOneBefore) {
    FixtureParameters p;
    p.position_m = 0.5;
    p.changes = {{2.0, {}, false, {}}, {1.0, {}, true, {}}};
    FixtureWalker w(p, 0.75);
    w.to(0.75, 1.5);
    EXPECT_TRUE(w.fixture.present());
    w.to(0.75, 1.5);  // gone and back at 2 s
    EXPECT_TRUE(w.fixture.present());
    std::vector<std::string> phases;
    for (const auto& [time_s, phase] : w.events) phases.push_back(phase);
    EXPECT_EQ(phases, (std::vector<std::string>{"touched", "removed", "left", "placed", "touched"}));
}

using Events = std::vector<std::pair<double, std::string>>;

// The plane jumps inwards past a needle that goes inwards: contact ends then, not with the step.
TEST(ForbiddenRegion, APlaneThatJumpsAwayIsLeftThen) {
    FixtureParameters p = with_change({0.5, {}, true, 0.875});
    p.position_m = 0.375;
    FixtureWalker w(p, 0.25);
    w.to(0.75, 1);
    EXPECT_EQ(w.events, (Events{{0.25, "touched"}, {0.5, "moved"}, {0.5, "left"}}));
}

// It jumps outwards past a needle that retreats but does not reach it.
TEST(ForbiddenRegion, APlaneThatJumpsInFrontIsTouchedThen) {
    FixtureParameters p = with_change({0.25, {}, true, 0.25});
    p.position_m = 0.875;
    FixtureWalker w(p, 0.75);
    w.to(0.5, 1);
    EXPECT_EQ(w.events, (Events{{0.25, "moved"}, {0.25, "touched"}}));
}

// The contact lies wholly within the step: where the needle ends says nothing about it.
TEST(ForbiddenRegion, AContactWithinAStepIsTouchedAndLeft) {
    FixtureParameters p = with_change({0.25, {}, true, 0.5});
    p.position_m = 0.875;
    FixtureWalker w(p, 0.75);
    w.to(0.25, 1);
    EXPECT_EQ(w.events, (Events{{0.25, "moved"}, {0.25, "touched"}, {0.5, "left"}}));
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
}

}  // namespace
}  // namespace thimble
