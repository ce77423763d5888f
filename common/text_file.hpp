// A whole text, written into a file at once.
#pragma once

#include <filesystem>
#include <string_view>

namespace thimble {

// Replaces the file. Throws Error (run failed) naming it if it cannot be written to its end.
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace thimble
