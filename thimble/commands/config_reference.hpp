// Every key that a file of a kind may have, asked from the readers themselves: they read small files while the file notes
// what they ask for.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "common/config.hpp"

namespace thimble {

// By dotted path; an entry of several tables is "table[].key". Tables stand among them, with the type "table" or "tables".
std::map<std::string, KeyDeclaration> session_file_keys();
std::map<std::string, KeyDeclaration> scene_file_keys();    // docs/scenes.md
std::map<std::string, KeyDeclaration> profile_file_keys();  // docs/network-profiles.md

// Of the key's physical unit, which its name ends in: "N/m" of "stiffness_N_per_m", empty where there is none.
std::string unit_of_key(std::string_view key);

// A table in Markdown for each table of the file, or one JSON object by path.
std::string keys_as_markdown(const std::map<std::string, KeyDeclaration>& keys);
std::string keys_as_json(const std::map<std::string, KeyDeclaration>& keys);

}  // namespace thimble
