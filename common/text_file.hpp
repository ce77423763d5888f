// A whole text, written into a file at once, and the folder for it.
#pragma once

#include <filesystem>
#include <string_view>

namespace thimble {

// Replaces the file. Throws Error (run failed) naming it if it cannot be written to its end.
void write_text_file(const std::filesystem::path& path, std::string_view text);

// With those on the way; an empty path is where the program is. Throws Error (usage) naming it if it cannot be made.
void make_folder(const std::filesystem::path& folder);

}  // namespace thimble
