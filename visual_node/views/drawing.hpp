// Small words for ImGui's draw list: colours by name, whole pixels, text that ends where it should.
#pragma once

#include <imgui.h>

#include "visual_node/views/text_line.hpp"
#include "visual_node/views/view_layout.hpp"
#include "visual_node/window/colours.hpp"

namespace thimble {

// `opacity` 0 to 1.
ImU32 paint(Colour colour, double opacity = 1);
ImVec4 gui_colour(Colour colour);
ImVec2 point(double x, double y);
ImVec2 corner(const Rect& rect);      // top left
ImVec2 far_corner(const Rect& rect);  // bottom right
ImVec2 extent(const Rect& rect);

// Small text for axes and legends. Returns its width.
double draw_text(ImDrawList& list, const ImVec2& where, Colour colour, const char* text);
// Ends at `where`.x.
void draw_text_left_of(ImDrawList& list, const ImVec2& where, Colour colour, const char* text);
double small_text_height();

// Dashes of `dash` pixels and gaps as long, from top to bottom.
void draw_dashed_vertical(ImDrawList& list, double x, double top, double bottom, double width, double dash,
                          Colour colour);

// Filled: hides what is behind it. Bare: the window's own background is its background, because each pixel that is painted
// twice costs where OpenGL is software.
enum class Ground { kFilled, kBare };

// A plain ImGui window at this place, which can neither be moved nor closed, and scrolls what does not fit. Call ImGui::End()
// after it in any case.
void begin_fixed(const char* name, const Rect& rect, Ground ground);

}  // namespace thimble
