// The types of element a scene can hold. To add one: a file elements/NAME.cpp that defines read_NAME, and its
// name in this list. examples/additions/element.patch does both.
#pragma once

#include <span>

#include "slave_sim/scene_declaration.hpp"

#define THIMBLE_ELEMENT_TYPES(ELEMENT) \
    ELEMENT(tissue)                    \
    ELEMENT(vessel)                    \
    ELEMENT(fixture)                   \
    ELEMENT(guidance)

namespace thimble {

#define THIMBLE_DECLARE_READER(type) \
    void read_##type(const ConfigTable& table, const std::string& name, SceneDeclaration& scene);
THIMBLE_ELEMENT_TYPES(THIMBLE_DECLARE_READER)
#undef THIMBLE_DECLARE_READER

std::span<const ElementType> element_types();

// The keys of a tissue's table, for every element that is made of tissue. Those that the table leaves out keep the value they
// have in `defaults`. Throws Error (usage).
TissueParameters read_tissue_parameters(const ConfigTable& table, TissueParameters defaults);
ElementDeclaration declare_tissue(const std::string& name, const TissueParameters& parameters);

}  // namespace thimble
