// The tissue against recorded needles solved at 40 digits (tests/golden/tissue.json).
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "slave_sim/elements/forbidden_region.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "tests/unit/slave_sim/phases.hpp"

namespace thimble {
namespace {

using nlohmann::json;

struct TimedEvent {
    double t_s;
    TissuePhase phase;
};

struct Golden {
    std::string name;
    TissueParameters parameters;
    FixtureParameters fixture;
    std::vector<double> t_s, needle_m, surface_m, velocity_m_per_s, force_N;
    std::vector<TissuePhase> phase;
    std::vector<TimedEvent> events;
};

double number(const json& text) { return std::stod(text.get<std::string>()); }

std::vector<double> numbers(const json& texts) {
    std::vector<double> values;
    for (const json& text : texts) values.push_back(number(text));
    return values;
}

Golden parse(const json& j) {
    Golden g;
    g.name = j.at("name");
    const json& p = j.at("params");
    g.parameters = {number(p.at("M")), number(p.at("K")),  number(p.at("B")),
                    number(p.at("V")), number(p.at("Fp")), number(p.at("zbar"))};
    g.fixture.stiffness_N_per_m = number(p.at("Kvf"));
    g.fixture.position_m = number(p.at("zvf"));
    g.t_s = numbers(j.at("t"));
    g.needle_m = numbers(j.at("z_needle"));
    g.surface_m = numbers(j.at("z_tissue"));
    g.velocity_m_per_s = numbers(j.at("v_tissue"));
    g.force_N = numbers(j.at("force"));
    for (const json& mode : j.at("mode")) g.phase.push_back(phase_named(mode.get<std::string>()));
    for (const json& e : j.at("events"))
        g.events.push_back({number(e.at("t")), phase_named(e.at("mode").get<std::string>())});
    return g;
}

const std::vector<Golden>& golden_cases() {
    static const std::vector<Golden> cases = [] {
        std::ifstream in(THIMBLE_GOLDEN_DIR "/tissue.json");
        std::vector<Golden> all;
        for (const json& j : json::parse(in)) all.push_back(parse(j));
        return all;
    }();
    return cases;
}

bool near_event(const Golden& g, double t_s) {
    for (const TimedEvent& e : g.events) {
        if (std::abs(e.t_s - t_s) < 1e-9) return true;
    }
    return false;
}

// How a recorded interval is walked: the cached propagator wants one and the same duration every time, uneven
// pieces along the same line force a new propagator for each.
struct Walk {
    const char* name;
    bool same_duration;
    std::vector<double> cuts;  // fractions of the interval, ending with 1
};

class TissueGolden : public testing::TestWithParam<Walk> {};

void walk_interval(const Golden& g, std::size_t i, const Walk& walk, ExactTissue& tissue,
                   std::vector<TimedEvent>& found) {
    const double dt_s = walk.same_duration ? g.t_s[1] - g.t_s[0] : g.t_s[i] - g.t_s[i - 1];
    double before = 0;
    for (const double cut : walk.cuts) {
        Transitions events;
        const double to_m =
            cut == 1 ? g.needle_m[i] : g.needle_m[i - 1] + cut * (g.needle_m[i] - g.needle_m[i - 1]);
        tissue.advance((cut - before) * dt_s, to_m, events);
        for (const Transition& e : events) {
            found.push_back({g.t_s[i - 1] + before * dt_s + e.offset_s, phase_named(e.phase)});
        }
        before = cut;
    }
}

TEST_P(TissueGolden, SamplesAndEvents) {
    ASSERT_EQ(golden_cases().size(), 6u);
    for (const Golden& g : golden_cases()) {
        SCOPED_TRACE(g.name);
        ExactTissue tissue(g.parameters);
        tissue.reset(g.needle_m[0]);
        std::vector<TimedEvent> found;
        std::size_t compared = 0;
        for (std::size_t i = 1; i < g.t_s.size(); ++i) {
            walk_interval(g, i, GetParam(), tissue, found);
            if (near_event(g, g.t_s[i])) continue;
            const TissueState s = tissue.state();
            ASSERT_EQ(s.phase, g.phase[i]) << "t " << g.t_s[i];
            ASSERT_NEAR(s.position_surface_m, g.surface_m[i], 1e-12) << "t " << g.t_s[i];
            ASSERT_NEAR(s.velocity_surface_m_per_s, g.velocity_m_per_s[i], 1e-10) << "t " << g.t_s[i];
            const double force_N = s.force_N + ForbiddenRegion(g.fixture).touch(g.needle_m[i]).force_N;
            ASSERT_NEAR(force_N, g.force_N[i], 1e-9) << "t " << g.t_s[i];
            ++compared;
        }
        EXPECT_GE(compared + g.events.size(), g.t_s.size() - 1);
        ASSERT_EQ(found.size(), g.events.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i].t_s, g.events[i].t_s, 1e-9);
            EXPECT_EQ(found[i].phase, g.events[i].phase);
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
