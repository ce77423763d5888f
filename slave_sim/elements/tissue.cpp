// [tissue], or [[tissue]] for several: layers, each with a surface of its own, deeper ones further along z.
#include "slave_sim/element_types.hpp"
#include "slave_sim/elements/tissue_table.hpp"

namespace thimble {

TissueParameters read_tissue_parameters(const ConfigTable& table, TissueParameters p) {
    p.mass_kg = table.number("mass_kg", p.mass_kg, 1e-15, 1e9);
    p.stiffness_N_per_m = table.number("stiffness_N_per_m", p.stiffness_N_per_m, 0, 1e9);
    p.damping_Ns_per_m = table.number("damping_Ns_per_m", p.damping_Ns_per_m, 0, 1e9);
    p.drag_Ns_per_m = table.number("drag_Ns_per_m", p.drag_Ns_per_m, 0, 1e9);
    p.puncture_force_N = table.number("puncture_force_N", p.puncture_force_N, 1e-9, 1e9);
    p.rest_position_m = table.number("rest_position_m", p.rest_position_m, -1, 1);
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
