// Every key that a file of a kind may have, as the readers describe them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"

namespace thimble {

// In the order of reading. Tables stand among them, with the type "table" or "tables".
std::vector<KeyDeclaration> session_file_keys();
std::vector<KeyDeclaration> scene_file_keys();    // docs/scenes.md
std::vector<KeyDeclaration> page_file_keys();     // docs/real-subjects.md
std::vector<KeyDeclaration> profile_file_keys();  // docs/network-profiles.md

// Of the key's physical unit, which its name ends in: "N/m" of "stiffness_N_per_m", empty where there is none.
std::string unit_of_key(std::string_view key);

// A table in Markdown for each table of the file; one JSON object by path; a JSON Schema (draft 2020-12) of the file.
std::string keys_as_markdown(const std::vector<KeyDeclaration>& keys);
std::string keys_as_json(const std::vector<KeyDeclaration>& keys);
std::string keys_as_schema(const std::vector<KeyDeclaration>& keys);

}  // namespace thimble
