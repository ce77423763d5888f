// The elements of a scene, before a solver is chosen: read from a file, copied freely, built by NeedleScene.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "slave_sim/element.hpp"
#include "slave_sim/tissue_solver.hpp"

namespace thimble {

// Selects the sum that an element's force belongs to, and the needle position that it follows: tissue the smooth one,
// whose slope is the estimated velocity; fixtures the encoder's reading.
enum class ElementKind { kTissue, kFixture };

struct ElementDeclaration {
    std::string name;  // in event lists
    ElementKind kind = ElementKind::kTissue;
    double position_m = 0;  // where the needle first meets it
    std::function<std::unique_ptr<Element>(const TissueMaker& make_tissue)> make;
};

struct SceneDeclaration {
    std::string name;
    std::vector<ElementDeclaration> elements;
};

// An element type: a table (or an array of tables) of the scene file, and who reads one of them. A reader
// appends what the table declares; `name` is unique in the scene. Throws Error (usage).
struct ElementType {
    std::string_view table;
    void (*read)(const ConfigTable& table, const std::string& name, SceneDeclaration& scene);
};

}  // namespace thimble
