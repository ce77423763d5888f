// The tissue against recorded needles solved at 40 digits (tests/golden/tissue.json).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "slave_sim/elements/forbidden_region.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "tests/read_text.hpp"
#include "tests/unit/slave_sim/phases.hpp"

namespace thimble {
namespace {

using nlohmann::json;

double number(const json& text) { return std::stod(text.get<std::string>()); }

TissuePhase phase(const json& name) { return phase_named(name.get<std::string>()); }

bool near_event(const json& events, double t_s) {
    return std::any_of(events.begin(), events.end(),
                       [t_s](const json& e) { return std::abs(number(e.at("t")) - t_s) < 1e-9; });
}

struct TimedEvent {
    double t_s;
    TissuePhase phase;
};

// How a recorded interval is walked: the cached propagator wants one and the same duration every time, uneven
// pieces along the same line force a new propagator for each.
struct Walk {
    const char* name;
    bool same_duration;
    std::vector<double> cuts;  // fractions of the interval, ending with 1
};

class TissueGolden : public testing::TestWithParam<Walk> {};

void walk_interval(const json& g, std::size_t i, const Walk& walk, ExactTissue& tissue,
                   std::vector<TimedEvent>& found) {
    const double from_s = number(g.at("t")[i - 1]);
    const double dt_s =
        walk.same_duration ? number(g.at("t")[1]) - number(g.at("t")[0]) : number(g.at("t")[i]) - from_s;
    const double from_m = number(g.at("z_needle")[i - 1]), to_m = number(g.at("z_needle")[i]);
    double before = 0;
    for (const double cut : walk.cuts) {
        Transitions events;
        tissue.advance((cut - before) * dt_s, cut == 1 ? to_m : from_m + cut * (to_m - from_m), events);
        for (const Transition& e : events)
            found.push_back({from_s + before * dt_s + e.offset_s, phase_named(e.phase)});
        before = cut;
    }
}

TEST_P(TissueGolden, SamplesAndEvents) {
    const json cases = json::parse(read_text(THIMBLE_GOLDEN_DIR "/tissue.json"));
    ASSERT_EQ(cases.size(), 6u);
    for (const json& g : cases) {
        SCOPED_TRACE(g.at("name").get<std::string>());
        const json &p = g.at("params"), &events = g.at("events");
        ExactTissue tissue({number(p.at("M")), number(p.at("K")), number(p.at("B")), number(p.at("V")),
                            number(p.at("Fp")), number(p.at("zbar"))});
        const ForbiddenRegion fixture({number(p.at("Kvf")), 0, number(p.at("zvf")), {}});
        tissue.reset(number(g.at("z_needle")[0]));
        std::vector<TimedEvent> found;
        std::size_t compared = 0;
        for (std::size_t i = 1; i < g.at("t").size(); ++i) {
            walk_interval(g, i, GetParam(), tissue, found);
            const double t_s = number(g.at("t")[i]);
            if (near_event(events, t_s)) continue;
            const TissueState s = tissue.state();
            ASSERT_EQ(s.phase, phase(g.at("mode")[i])) << "t " << t_s;
            ASSERT_NEAR(s.position_surface_m, number(g.at("z_tissue")[i]), 1e-12) << "t " << t_s;
            ASSERT_NEAR(s.velocity_surface_m_per_s, number(g.at("v_tissue")[i]), 1e-10) << "t " << t_s;
            const double force_N = s.force_N + fixture.touch(number(g.at("z_needle")[i])).force_N;
            ASSERT_NEAR(force_N, number(g.at("force")[i]), 1e-9) << "t " << t_s;
            ++compared;
        }
        EXPECT_GE(compared + events.size(), g.at("t").size() - 1);
        ASSERT_EQ(found.size(), events.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i].t_s, number(events[i].at("t")), 1e-9);
            EXPECT_EQ(found[i].phase, phase(events[i].at("mode")));
        }
        EXPECT_EQ(tissue.unresolved_steps(), 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Walks, TissueGolden,
                         testing::Values(Walk{"cached", true, {1.0}}, Walk{"recorded", false, {1.0}},
                                         Walk{"uneven", false, {0.3, 0.37, 0.9, 1.0}}),
                         [](const auto& walk) { return walk.param.name; });

}  // namespace
}  // namespace thimble
