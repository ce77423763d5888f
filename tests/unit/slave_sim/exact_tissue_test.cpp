// One named problem for each way a hybrid stepper goes wrong.
#include "slave_sim/exact_tissue.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/slave_sim/phases.hpp"
#include "tests/unit/slave_sim/random_values.hpp"

namespace thimble {
namespace {

using enum TissuePhase;

using Phases = std::vector<TissuePhase>;

constexpr double kRest_m = 0.020;

TEST(ExactTissue, ForceResistsWhatTheNeedleDoes) {
    ExactTissue tissue{TissueParameters{}};
    Transitions events;
    tissue.reset(kRest_m - 0.001);
    tissue.advance(0.2, kRest_m + 0.001, events);  // 10 mm/s: f = 0.052 N at the end
    EXPECT_EQ(phases(events), Phases{kContact});
    EXPECT_NEAR(tissue.state().force_N, -(2 * 0.001 + 5 * 0.01), 1e-12);
    EXPECT_NEAR(tissue.state().position_surface_m, kRest_m + 0.001, 1e-17);

    tissue.reset(kRest_m + 0.05);
    tissue.advance(0.1, kRest_m + 0.06, events);
    EXPECT_EQ(tissue.state().phase, kPenetrated);
    EXPECT_LT(tissue.state().force_N, 0);  // deeper: pushed out
    tissue.advance(0.1, kRest_m + 0.05, events);
    EXPECT_GT(tissue.state().force_N, 0);  // out: held back
}

TEST(ExactTissue, PullingLetsGoOfTheSurface) {
    ExactTissue tissue{TissueParameters{}};
    Transitions events;
    tissue.reset(kRest_m);
    tissue.advance(4, kRest_m + 0.02, events);
    events.clear();
    tissue.advance(0.1, kRest_m + 0.018, events);  // f = 0.036..0.04 - 0.1 < 0 at once
    ASSERT_EQ(phases(events), Phases{kFree});
    EXPECT_EQ(events[0].offset_s, 0);
    EXPECT_EQ(tissue.state().force_N, 0);
    EXPECT_GT(tissue.state().position_surface_m, kRest_m + 0.018);
}

// The release lies inside the step; the surface leaves with f just below zero and must not come straight
// back.
TEST(ExactTissue, ReleaseInsideAStepIsOneEvent) {
    for (int i = 0; i < 2000; ++i) {
        const double speed = 1e-5 + 3.7e-6 * i;  // up to 7.4 mm/s: later than the start of the step
        ExactTissue tissue{TissueParameters{}};
        Transitions events;
        tissue.reset(kRest_m);
        tissue.advance(4, kRest_m + 0.02, events);
        events.clear();
        const double end_m = 0.02 - 5 * 0.02;
        tissue.advance((0.02 - end_m) / speed, kRest_m + end_m, events);
        ASSERT_EQ(phases(events), Phases{kFree}) << speed;
        EXPECT_NEAR(events[0].offset_s, (0.02 - 2.5 * speed) / speed, 1e-9) << speed;  // 2 x = 5 v
    }
}

// An undamped surface swings at 1e6 rad/s beneath a needle that slowly comes nearer: they touch once in a
// swing, and as the surface would have to be pulled there, it is let go at once.
struct Swinging {
    ExactTissue tissue{TissueParameters{1e-6, 1e6, 0, 0, 1e5, 0}};
    Transitions events;

    Swinging() {
        tissue.reset(-2e-3);
        tissue.advance(1e-3, 1e-3, events);
        tissue.advance(1e-9, 0.5e-3, events);
        tissue.advance(1e-9, -0.3e-3, events);
        events.clear();
    }
};

// Of a step of 1 ms all 159 swings are found. Of 1.6e9 swings 64 transitions are, then the word that it was given up,
// and at the end needle and phase agree again.
TEST(ExactTissue, EverySwingOfALongStepIsFoundAndChatterIsBounded) {
    for (const auto& [duration_s, least, most, unresolved] :
         {std::tuple{1e-3, 2 * 159 - 4, 2 * 159 + 4, 0U}, {1e4, 64 + 1, 64 + 1 + 2, 1U}}) {
        Swinging s;
        s.tissue.advance(duration_s, -0.2e-3, s.events);
        const auto transitions = static_cast<int>(s.events.size() + s.events.overflows());
        EXPECT_GE(transitions, least);
        EXPECT_LE(transitions, most);
        EXPECT_EQ(s.tissue.unresolved_steps(), unresolved);
        const TissueState end = s.tissue.state();
        EXPECT_EQ(end.phase == TissuePhase::kPenetrated, -0.2e-3 > end.position_surface_m);
        EXPECT_LE(std::abs(end.position_surface_m), 1.1e-3);
    }
}

// As Swinging, but 100 N pierce: beyond its rest position the surface is touched and pierced in each swing.
struct GivenUp {
    static constexpr double kStiffness_N_per_m = 1e6, kPuncture_N = 100;

    ExactTissue tissue{TissueParameters{1e-6, kStiffness_N_per_m, 0, 0, kPuncture_N, 0}};
    Transitions events{Transitions::kUnlimited};
    std::string before;  // the phase when the step was given up
    std::string after;   // what it entered then
    std::size_t found = 0;

    // The needle pierces a fast surface, waits while that swings, and goes to `from_m` at once; then the long step.
    GivenUp(double wait_s, double from_m, double to_m, double duration_s) {
        tissue.reset(-1e-3);
        tissue.advance(2e-6, 1e-3, events);
        tissue.advance(wait_s, 1e-3, events);
        tissue.advance(1e-9, from_m, events);
        events.clear();
        tissue.advance(duration_s, to_m, events);
        const auto word = std::find_if(events.begin(), events.end(),
                                       [](const Transition& e) { return e.phase == "unresolved"; });
        if (word == events.begin() || word == events.end()) return;
        before = (word - 1)->phase;
        found = static_cast<std::size_t>(word - events.begin());
        for (auto e = word + 1; e != events.end(); ++e) {
            EXPECT_EQ(e->offset_s, duration_s);
            after += " " + std::string(e->phase);
        }
    }
    // The phase that the guards require at the end of the step.
    std::string asked(double needle_m) const {
        const double gap_m = needle_m - tissue.state().position_surface_m;
        if (before == "free") return gap_m > 0 ? " contact penetrated" : "";
        if (before == "penetrated") return gap_m < 0 ? " free" : "";
        const double force_N = kStiffness_N_per_m * needle_m;
        if (force_N < 0) return " free";
        return force_N > kPuncture_N ? " penetrated" : "";
    }
};

TEST(ExactTissue, AStepThatWasGivenUpEndsInThePhaseThatItsGuardsAsk) {
    std::set<std::string> seen;
    for (const double duration_s : {0.05, 1e4}) {
        for (const auto& [from_m, to_m] :
             {std::pair{0.3e-3, 0.2e-3}, {0.3e-3, 0.05e-3}, {-0.25e-3, -0.2e-3}}) {
            for (int i = 0; i < 60; i += 2) {
                const GivenUp step(0.5e-6 + 0.1e-6 * i, from_m, to_m, duration_s);
                ASSERT_EQ(step.tissue.unresolved_steps(), 1U) << from_m << " " << i;
                ASSERT_NE(step.before, "") << from_m << " " << i;
                ASSERT_EQ(step.after, step.asked(to_m)) << step.before << " " << from_m << " " << i;
                // All of them within a millionth of the long step.
                if (duration_s == 1e4) {
                    ASSERT_EQ(step.found, 64U);
                }
                seen.insert(step.before + step.after);
            }
        }
    }
    EXPECT_EQ(seen, (std::set<std::string>{"free", "free contact penetrated", "penetrated", "penetrated free",
                                           "contact", "contact free", "contact penetrated"}));
}

// The needle leaves the reach of the swings, and comes back into it late in the step.
TEST(ExactTissue, ChatterLateInAStepIsGivenUpAsSoon) {
    Swinging s;
    s.tissue.advance(1e-3, -0.25e-3, s.events);
    s.tissue.advance(1e-9, -0.5e-3, s.events);
    Transitions events(Transitions::kUnlimited);
    s.tissue.advance(1e4, -0.2e-3, events);
    EXPECT_EQ(s.tissue.unresolved_steps(), 1U);
    ASSERT_GT(events.size(), 64U);
    EXPECT_GT(events[0].offset_s, 6000);
    EXPECT_EQ(events[64].phase, "unresolved");
}

// Found by fuzz_scene: each swing comes back to just where the needle released it, and all of them were looked at.
TEST(ExactTissue, SwingsUpToARestingNeedleAreNotCountedOneByOne) {
    Swinging s;
    s.tissue.advance(1e-3, -0.2e-3, s.events);
    s.tissue.advance(1e-3, -0.2e-3, s.events);  // the needle is met, and waits there
    s.events.clear();
    const std::uint64_t before = s.tissue.evaluations();
    s.tissue.advance(1e4, -0.2e-3, s.events);  // 1.6e9 swings
    EXPECT_EQ(s.events.size(), 0u);
    EXPECT_LT(s.tissue.evaluations() - before, 100u);
    EXPECT_EQ(s.tissue.unresolved_steps(), 0u);
}

TEST(ExactTissue, AStepCostsNoMoreThanItMay) {
    Swinging s;
    s.tissue.advance(0.05, -0.2e-3, s.events);  // 8000 swings, each met, none within a millionth of the step
    EXPECT_LT(s.tissue.evaluations(), ExactTissue::kMostEvaluations + 400);
    EXPECT_EQ(s.tissue.unresolved_steps(), 1u);
    EXPECT_EQ(s.tissue.state().phase, TissuePhase::kFree);
    EXPECT_LE(std::abs(s.tissue.state().position_surface_m), 1.1e-3);
    // The next one may cost as much again: here some 200 swings.
    s.tissue.advance(1e-3, -0.1e-3, s.events);
    EXPECT_EQ(s.tissue.unresolved_steps(), 1u);
}

// Each step from the same state. With damping: an undamped surface comes back to where it was let go
// tangentially, and whether it touches there is decided by rounding.
TEST(TissueProperty, AStepSplitAlongItsLineIsTheSameStep) {
    EXPECT_TRUE(rc::check("split", [] {
        TissueParameters p = random_tissue(-1);
        p.rest_position_m = between(-0.01, 0.03);
        if (p.damping_Ns_per_m == 0) p.damping_Ns_per_m = 0.1;
        ExactTissue whole{p};
        double from_m = p.rest_position_m - 0.01;
        whole.reset(from_m);
        for (const PathSample& step : random_path(p.rest_position_m)) {
            ExactTissue split = whole;
            Transitions at_once;
            Transitions parts;
            const double cut = between(0.01, 0.99);
            const double first_s = cut * step.duration_s;
            whole.advance(step.duration_s, step.needle_m, at_once);
            split.advance(first_s, from_m + cut * (step.needle_m - from_m), parts);
            const std::size_t before_cut = parts.size();
            split.advance(step.duration_s - first_s, step.needle_m, parts);
            RC_ASSERT(phases(parts) == phases(at_once));
            for (std::size_t i = 0; i < parts.size(); ++i) {
                const double offset_s = parts[i].offset_s + (i < before_cut ? 0 : first_s);
                RC_ASSERT(std::abs(offset_s - at_once[i].offset_s) <= 1e-9);
            }
            const TissueState a = whole.state();
            const TissueState b = split.state();
            RC_ASSERT(a.phase == b.phase);
            RC_ASSERT(std::abs(a.position_surface_m - b.position_surface_m) <= 1e-12);
            RC_ASSERT(std::abs(a.velocity_surface_m_per_s - b.velocity_surface_m_per_s) <= 1e-10);
            RC_ASSERT(std::abs(a.force_N - b.force_N) <= 1e-9);
            from_m = step.needle_m;
        }
        RC_ASSERT(whole.unresolved_steps() == 0u);
    }));
}

TEST(Transitions, AFullListCountsWhatItDrops) {
    Transitions events(5);
    for (int i = 0; i < 8; ++i) events.push(0.001, "contact");
    EXPECT_EQ(events.size(), 5u);
    EXPECT_EQ(events.overflows(), 3u);
    events.clear();
    EXPECT_EQ(events.size(), 0u);
    EXPECT_EQ(events.overflows(), 3u);
}

}  // namespace
}  // namespace thimble
