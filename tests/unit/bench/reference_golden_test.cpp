// The reference solution against recorded needles, solved elsewhere at 40 digits and printed with 20
// (tests/golden/tissue.json).
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/reference_tissue.hpp"

namespace thimble {
namespace {

using nlohmann::json;

ReferenceNumber number(const json& text) { return ReferenceNumber(text.get<std::string>()); }

double distance(const ReferenceNumber& a, const ReferenceNumber& b) {
    return abs(a - b).convert_to<double>();
}

ReferenceParameters parameters(const json& p) {
    ReferenceParameters r;
    r.mass_kg = number(p.at("M"));
    r.stiffness_N_per_m = number(p.at("K"));
    r.damping_Ns_per_m = number(p.at("B"));
    r.drag_Ns_per_m = number(p.at("V"));
    r.puncture_force_N = number(p.at("Fp"));
    r.rest_position_m = number(p.at("zbar"));
    return r;
}

// The file's forces are of tissue and fixture together.
ReferenceNumber fixture_force_N(const json& p, const ReferenceNumber& needle_m) {
    const ReferenceNumber beyond_m = needle_m - number(p.at("zvf"));
    return beyond_m > 0 ? ReferenceNumber(-number(p.at("Kvf")) * beyond_m) : ReferenceNumber(0);
}

// At the instant of an event the file's left limit may be either side's.
bool at_event(const json& events, const ReferenceNumber& t_s) {
    for (const json& e : events) {
        if (distance(number(e.at("t")), t_s) < 1e-17) return true;
    }
    return false;
}

// The file has no velocity of the surface finer than 20 digits either, so half of the last of them decides.
constexpr double kPrinted = 1e-17;

void compare_sample(const json& c, std::size_t i, const ReferenceTissue& tissue) {
    const ReferenceState s = tissue.state();
    EXPECT_LT(distance(s.position_surface_m, number(c.at("z_tissue")[i])), kPrinted) << i;
    if (at_event(c.at("events"), number(c.at("t")[i]))) return;
    EXPECT_EQ(to_string(s.phase), c.at("mode")[i].get<std::string>()) << i;
    EXPECT_LT(distance(s.velocity_surface_m_per_s, number(c.at("v_tissue")[i])), kPrinted) << i;
    const ReferenceNumber force_N = s.force_N + fixture_force_N(c.at("params"), number(c.at("z_needle")[i]));
    EXPECT_LT(distance(force_N, number(c.at("force")[i])), 100 * kPrinted) << i;
}

TEST(ReferenceTissue, AgreesWithTheGoldenVectorsToTheirLastDigits) {
    std::ifstream in(THIMBLE_GOLDEN_DIR "/tissue.json");
    const json cases = json::parse(in);
    ASSERT_EQ(cases.size(), 6u);
    for (const json& c : cases) {
        SCOPED_TRACE(c.at("name").get<std::string>());
        ReferenceTissue tissue(parameters(c.at("params")));
        tissue.reset(number(c.at("z_needle")[0]));
        for (std::size_t i = 1; i < c.at("t").size(); ++i) {
            tissue.step(number(c.at("t")[i]) - number(c.at("t")[i - 1]), number(c.at("z_needle")[i]));
            compare_sample(c, i, tissue);
        }
        ASSERT_EQ(tissue.events().size(), c.at("events").size());
        for (std::size_t i = 0; i < tissue.events().size(); ++i) {
            const json& event = c.at("events")[i];
            EXPECT_LT(distance(tissue.events()[i].t_s, number(event.at("t"))), 10 * kPrinted) << i;
            EXPECT_EQ(to_string(tissue.events()[i].phase), event.at("mode").get<std::string>()) << i;
        }
    }
}

}  // namespace
}  // namespace thimble
