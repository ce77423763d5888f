// Every key that a session file may have, asked from the readers themselves: they read small files while the file notes what
// they ask for.
#pragma once

#include <map>
#include <string>

#include "common/config.hpp"

namespace thimble {

// By dotted path; an entry of several tables is "table[].key". Tables stand among them, with the type "table" or "tables".
std::map<std::string, KeyDeclaration> session_file_keys();

// A table in Markdown for each table of the file, or one JSON object by path.
std::string keys_as_markdown(const std::map<std::string, KeyDeclaration>& keys);
std::string keys_as_json(const std::map<std::string, KeyDeclaration>& keys);

}  // namespace thimble
