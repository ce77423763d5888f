// Scenes as TOML files: each table declares an element, and nothing else is computed.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "slave_sim/scene_declaration.hpp"

namespace thimble {

inline constexpr std::string_view kPaperScene = "paper.toml";

// Every element type's table of the file. Throws Error (usage).
SceneDeclaration read_scene(const ConfigFile& file, std::string_view name);

// A whole scene file, or one of the scenes that come with the program if there is no file of that name.
// Unknown tables and keys are errors.
SceneDeclaration load_scene(const std::filesystem::path& path);

// The scene of paper.toml as it came with the program.
SceneDeclaration paper_scene();

struct BuiltInScene {
    std::string_view name;  // "paper.toml"
    std::string_view text;
};
const std::vector<BuiltInScene>& built_in_scenes();  // deploy/scenes at build time

}  // namespace thimble
