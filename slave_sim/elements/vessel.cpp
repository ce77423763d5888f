// [vessel]: a blood vessel across the needle's way, felt as an abnormal resistance that gives way.
//
// Two thin walls, each a layer of tissue that is light, stiff, hard to pierce and hardly drags; the far wall
// lies diameter_m deeper. Between the two events "vessel.near penetrated" and "vessel.far penetrated" the tip
// is in the vessel. The keys are those of [tissue], of each wall.
#include "slave_sim/element_types.hpp"

namespace thimble {

void read_vessel(const ConfigTable& table, const std::string& name, SceneDeclaration& scene) {
    TissueParameters wall{0.01, 200, 5, 0.05, 0.5, 0.06};
    wall = read_tissue_parameters(table, wall);
    double diameter_m = 0.004;
    table.read("diameter_m", diameter_m, 0, 1, "Distance from wall to wall.");
    scene.elements.push_back(declare_tissue(name + ".near", wall));
    wall.rest_position_m += diameter_m;
    scene.elements.push_back(declare_tissue(name + ".far", wall));
}

}  // namespace thimble
