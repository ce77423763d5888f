// [fixture]: a forbidden region. [[fixture.event]]: its sudden changes.
#include <limits>

#include "slave_sim/element_types.hpp"
#include "slave_sim/elements/forbidden_region.hpp"

namespace thimble {

namespace {

constexpr double kLongestSeconds = 1e9;
constexpr double kNone =
    std::numeric_limits<double>::quiet_NaN();  // keys without a default: read only where given

FixtureChange read_change(const ConfigTable& table) {
    FixtureChange change;
    const bool timed = table.has("time_s");
    if (timed == table.has("after_contact_s")) {
        table.fail("time_s", "is one of two: give either time_s or after_contact_s");
    }
    auto& trigger = timed ? change.time_s : change.after_contact_s;
    trigger = table.number(timed ? "time_s" : "after_contact_s", kNone, 0, kLongestSeconds);
    if (table.has("position_m")) change.position_m = table.number("position_m", kNone, -1, 1);
    change.present = table.boolean("present", change.position_m.has_value());
    return change;
}

}  // namespace

void read_fixture(const ConfigTable& table, const std::string& name, SceneDeclaration& scene) {
    FixtureParameters p;
    p.stiffness_N_per_m = table.number("stiffness_N_per_m", p.stiffness_N_per_m, 0, 1e12);
    p.damping_Ns_per_m = table.number("damping_Ns_per_m", p.damping_Ns_per_m, 0, 1e9);
    p.position_m = table.number("position_m", p.position_m, -1, 1);
    for (const ConfigTable& event : table.tables("event")) p.changes.push_back(read_change(event));
    const auto make = [p](const TissueMaker&) { return std::make_unique<ForbiddenRegion>(p); };
    scene.elements.push_back({name, ElementKind::kFixture, p.position_m, make});
}

}  // namespace thimble
