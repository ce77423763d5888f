// [tissue], or [[tissue]] for several: layers, each with a surface of its own, deeper ones further along z.
#include "slave_sim/element_types.hpp"

namespace thimble {

TissueParameters read_tissue_parameters(const ConfigTable& table, TissueParameters p) {
    table.read("mass_kg", p.mass_kg, 1e-15, 1e9, "Mass M at the contact point.");
    table.read("stiffness_N_per_m", p.stiffness_N_per_m, 0, 1e9, "Stiffness K.");
    table.read("damping_Ns_per_m", p.damping_Ns_per_m, 0, 1e9, "Damping B.");
    table.read("drag_Ns_per_m", p.drag_Ns_per_m, 0, 1e9, "Drag V of the needle below the surface.");
    table.read("puncture_force_N", p.puncture_force_N, 1e-9, 1e9, "Puncture force F_p.");
    table.read("rest_position_m", p.rest_position_m, -1, 1, "Position of the surface at rest.");
    return p;
}

ElementDeclaration declare_tissue(const std::string& name, const TissueParameters& parameters) {
    return {name, ElementKind::kTissue, parameters.rest_position_m,
            [parameters](const TissueMaker& make_tissue) { return make_tissue(parameters); }};
}

void read_tissue(const ConfigTable& table, const std::string& name, SceneDeclaration& scene) {
    scene.elements.push_back(declare_tissue(name, read_tissue_parameters(table, {})));
}

}  // namespace thimble
