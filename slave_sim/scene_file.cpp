#include "slave_sim/scene_file.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "slave_sim/element_types.hpp"

namespace thimble {

namespace {

// The type's own name where there is one of it, else numbered from 1; or what the table says.
std::string name_of(const ConfigTable& table, std::string_view type, std::size_t index, std::size_t count) {
    std::string name = count == 1 ? std::string(type) : fmt::format("{}{}", type, index + 1);
    table.read("name", name,
               "Name in event lists; default: the name of the table, numbered if there are several.");
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return c == '_' || c == '-' || c == '.' || (c < 128 && std::isalnum(c) != 0);
    });
    if (!plain)
        table.fail("name", "may hold letters, digits, '_', '-' and '.' only: it appears in event lists");
    return name;
}

void claim(const ConfigTable& table, const std::string& name, std::set<std::string>& names) {
    if (!names.insert(name).second)
        table.fail("name", "\"{}\" is the name of another element, or of a part of one: choose another",
                   name);
}

// Also the names that a type gives to parts of it are taken: a tissue must not be called "vessel.near".
void read_type(const ConfigFile& file, const ElementType& type, std::set<std::string>& names,
               SceneDeclaration& scene) {
    const auto describe = [&type](const ConfigTable& table) {
        SceneDeclaration any;
        type.read(table, name_of(table, type.table, 0, 1), any);
    };
    const std::vector<ConfigTable> tables = file.root().tables(type.table, describe);
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const std::string name = name_of(tables[i], type.table, i, tables.size());
        claim(tables[i], name, names);
        const std::size_t known = scene.elements.size();
        type.read(tables[i], name, scene);
        for (std::size_t k = known; k < scene.elements.size(); ++k) {
            if (scene.elements[k].name != name) claim(tables[i], scene.elements[k].name, names);
        }
    }
}

const BuiltInScene* built_in(std::string_view name) {
    const auto& scenes = built_in_scenes();
    const auto found = std::find_if(scenes.begin(), scenes.end(),
                                    [name](const BuiltInScene& scene) { return scene.name == name; });
    return found == scenes.end() ? nullptr : &*found;
}

ConfigFile open(const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) return ConfigFile::load(path);
    if (const BuiltInScene* scene = built_in(path.string())) {
        return ConfigFile::parse(scene->text, scene->name);
    }
    std::vector<std::string_view> names;
    for (const BuiltInScene& scene : built_in_scenes()) names.push_back(scene.name);
    throw Error(ExitCode::kUsage, "{}: there is no such scene file; the built-in scenes are {}",
                path.string(), fmt::join(names, ", "));
}

}  // namespace

SceneDeclaration read_scene(const ConfigFile& file, std::string_view name) {
    SceneDeclaration scene;
    scene.name = name;
    std::set<std::string> names;
    for (const ElementType& type : element_types()) read_type(file, type, names, scene);
    return scene;
}

SceneDeclaration paper_scene() {
    // Each default of a session's settings has it.
    static const SceneDeclaration paper =
        read_scene(ConfigFile::parse(built_in(kPaperScene)->text, kPaperScene), kPaperScene);
    return paper;
}

SceneDeclaration load_scene(const std::filesystem::path& path) {
    const ConfigFile file = open(path);
    SceneDeclaration scene;
    file.read_all([&] { scene = read_scene(file, path.string()); });
    return scene;
}

}  // namespace thimble
