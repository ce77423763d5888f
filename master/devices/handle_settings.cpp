#include "master/devices/handle_settings.hpp"

namespace thimble {

HandleSettings read_handle_settings(const ConfigTable& table) {
    HandleSettings settings;
    const auto read = [&table](const char* key, double& value, double low, double high) {
        value = table.number(key, value, low, high);
    };
    read("encoder_resolution_m", settings.encoder_resolution_m, 1e-9, 1e-3);
    read("force_limit_N", settings.force_limit_N, 0.1, 100);
    read("moving_mass_kg", settings.mechanics.moving_mass_kg, 0.02, 5);
    read("damping_Ns_per_m", settings.mechanics.damping_Ns_per_m, 0, 50);
    read("friction_N", settings.mechanics.friction_N, 0, 5);
    read("friction_travel_m", settings.mechanics.friction_travel_m, 1e-6, 1e-3);
    settings.kind = static_cast<HandleKind>(table.choice("device", 0, {"simulated", "pointer", "hid"}));
    // Within what the lightest handle bears in steps of 0.1 ms.
    read("coupling_stiffness_N_per_m", settings.coupling.stiffness_N_per_m, 1, 10000);
    read("coupling_damping_Ns_per_m", settings.coupling.damping_Ns_per_m, 0, 100);
    settings.hid = read_hid_hand_settings(table.table("hid"));
    return settings;
}

}  // namespace thimble
