// The keys of a tissue's table, for every element that is made of tissue.
#pragma once

#include <string>

#include "slave_sim/scene_declaration.hpp"

namespace thimble {

// Keys that the table leaves out keep the value they have in `defaults`. Throws Error (usage).
TissueParameters read_tissue_parameters(const ConfigTable& table, TissueParameters defaults);
ElementDeclaration declare_tissue(const std::string& name, const TissueParameters& parameters);

}  // namespace thimble
