#include "slave_sim/slave_settings.hpp"

namespace thimble {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TissueParameters read_tissue(const ConfigTable& table) {
    TissueParameters t;
    t.mass_kg = table.number("mass_kg", t.mass_kg, 1e-9, 1e6);
    t.stiffness_N_per_m = table.number("stiffness_N_per_m", t.stiffness_N_per_m, 0, 1e6);
    // Some damping, so that a surface left alone comes to rest.
    t.damping_Ns_per_m = table.number("damping_Ns_per_m", t.damping_Ns_per_m, 1e-3, 1e6);
    t.drag_Ns_per_m = table.number("drag_Ns_per_m", t.drag_Ns_per_m, 0, 1e6);
    t.puncture_force_N = table.number("puncture_force_N", t.puncture_force_N, 1e-6, 1e6);
    t.rest_position_m = table.number("rest_position_m", t.rest_position_m, -1, 1);
    return t;
}

}  // namespace

SlaveSettings read_slave_settings(const ConfigFile& file) {
    SlaveSettings s;
    s.tissue = read_tissue(file.table("tissue"));
    const ConfigTable fixture = file.table("fixture");
    s.fixture.stiffness_N_per_m = fixture.number("stiffness_N_per_m", s.fixture.stiffness_N_per_m, 0, 1e6);
    s.fixture.position_m = fixture.number("position_m", s.fixture.position_m, -1, 1);
    s.contact_hold =
        file.table("trial").seconds("contact_hold_s", s.contact_hold, milliseconds(1), seconds(600));
    const ConfigTable own = file.table("slave_sim");
    s.stale_after = own.seconds("stale_after_s", s.stale_after, milliseconds(1), seconds(10));
    s.longest_step = own.seconds("longest_step_s", s.longest_step, milliseconds(1), seconds(10));
    return s;
}

}  // namespace thimble
