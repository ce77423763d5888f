// [fixture]: a forbidden region. [[fixture.event]]: its sudden changes.
#include "slave_sim/element_types.hpp"
#include "slave_sim/elements/forbidden_region.hpp"

namespace thimble {

namespace {

constexpr double kLongestSeconds = 1e9;

FixtureChange read_change(const ConfigTable& table) {
    FixtureChange change;
    table.read("time_s", change.time_s, 0, kLongestSeconds,
               "When, on the scene's clock; or after_contact_s.");
    table.read("after_contact_s", change.after_contact_s, 0, kLongestSeconds,
               "After so much unbroken contact.");
    table.read("position_m", change.position_m, -1, 1, "Where it then is; without it where it was.");
    change.present = change.position_m.has_value();
    table.read("present", change.present, "Whether it is there; with position_m it is, unless this says no.");
    return change;
}

}  // namespace

void read_fixture(const ConfigTable& table, const std::string& name, SceneDeclaration& scene) {
    FixtureParameters p;
    table.read("stiffness_N_per_m", p.stiffness_N_per_m, 0, 1e12, "Per metre of needle travel.");
    table.read("damping_Ns_per_m", p.damping_Ns_per_m, 0, 1e9,
               "Times the estimated velocity; the fixture never pulls.");
    table.read("position_m", p.position_m, -1, 1, "Nominal depth.");
    for (const ConfigTable& event : table.tables("event", read_change)) {
        p.changes.push_back(read_change(event));
        if (p.changes.back().time_s.has_value() == p.changes.back().after_contact_s.has_value()) {
            event.fail("time_s", "is one of two: give either time_s or after_contact_s");
        }
    }
    const auto make = [p](const TissueMaker&) { return std::make_unique<ForbiddenRegion>(p); };
    scene.elements.push_back({name, ElementKind::kFixture, p.position_m, make});
}

}  // namespace thimble
