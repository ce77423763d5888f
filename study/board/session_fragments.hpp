// Pieces of session files, as TOML text, put together.
#pragma once

#include <span>
#include <string>

namespace thimble {

// Later fragments replace keys of earlier ones; their tables are joined. Throws Error (usage) that names `name` for what is not TOML.
std::string joined_fragments(std::span<const std::string> fragments, const std::string& name);

}  // namespace thimble
