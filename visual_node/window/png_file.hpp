// Pictures as PNG files, 8 bits per colour, no alpha.
#pragma once

#include <filesystem>

#include "visual_node/window/image.hpp"

namespace thimble {

// The file appears whole or not at all. Throws Error (data) if it cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);
// Throws Error (data) if the file is missing or no PNG.
Image read_png(const std::filesystem::path& path);

}  // namespace thimble
