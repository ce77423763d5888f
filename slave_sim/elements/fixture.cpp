// [fixture]: a forbidden region. [[fixture.event]]: its sudden changes.
#include "slave_sim/element_types.hpp"
#include "slave_sim/elements/forbidden_region.hpp"

namespace thimble {

namespace {

constexpr double kLongestSeconds = 1e9;

FixtureChange read_change(const ConfigTable& table) {
    FixtureChange change;
    table.read("time_s", change.time_s, 0, kLongestSeconds,
               "Time of the change, on the scene's clock; or use after_contact_s.");
    table.read("after_contact_s", change.after_contact_s, 0, kLongestSeconds,
               "Unbroken contact with the fixture after which the change happens.");
    table.read("position_m", change.position_m, -1, 1, "New position; default: unchanged.");
    change.present = change.position_m.has_value();
    table.read("present", change.present,
               "true: the fixture exists from now on; default with position_m: true.");
    return change;
}

}  // namespace

void read_fixture(const ConfigTable& table, const std::string& name, SceneDeclaration& scene) {
    FixtureParameters p;
    table.read("stiffness_N_per_m", p.stiffness_N_per_m, 0, 1e12, "Stiffness, per metre of needle travel.");
    table.read("damping_Ns_per_m", p.damping_Ns_per_m, 0, 1e9,
               "Damping, times the estimated velocity; the fixture never pulls.");
    table.read("position_m", p.position_m, -1, 1, "Nominal depth of the fixture.");
    for (const ConfigTable& event : table.tables("event", read_change)) {
        p.changes.push_back(read_change(event));
        if (p.changes.back().time_s.has_value() == p.changes.back().after_contact_s.has_value()) {
            event.fail("time_s", "give exactly one of time_s and after_contact_s");
        }
    }
    const auto make = [p](const TissueMaker&) { return std::make_unique<ForbiddenRegion>(p); };
    scene.elements.push_back({name, ElementKind::kFixture, p.position_m, make});
}

}  // namespace thimble
