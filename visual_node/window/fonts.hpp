// The program's font, and what it can draw.
#pragma once

#include <string>

struct ImFont;
struct ImFontAtlas;

namespace thimble {

// Latin-1, and of what lies beyond it the characters of `text`. The atlas is built with it.
struct Fonts {
    ImFont* plain = nullptr;
    ImFont* large = nullptr;
};
Fonts build_fonts(ImFontAtlas& atlas, double content_scale, const std::string& text);

// The characters of a text (UTF-8) that would be drawn as boxes, each once: "U+1F600, U+4E2D"; empty if there are none.
std::string undrawable(const std::string& text);
// Throws Error (usage) that names them: a subject is not to read boxes.
void check_drawable(const std::string& instructions);

}  // namespace thimble
