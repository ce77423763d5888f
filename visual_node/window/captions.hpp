// Text over the scene, by Dear ImGui's draw lists: between GuiLayer::begin() and end().
#pragma once

#include <string>

#include "visual_node/window/frame_times.hpp"
#include "visual_node/window/gui_layer.hpp"
#include "visual_node/window/page_text.hpp"
#include "visual_node/window/picture.hpp"

namespace thimble {

// The numbers of the bar's scale, "N" behind the last.
void draw_bar_scale(const Picture& picture);
// Covers the scene. Lines too long for the window are broken between words.
void draw_page(const GuiLayer& gui, const PageText& text);
// A box in the middle.
void draw_key_help(const std::string& keys);
// One line at the bottom left: how old what is seen is.
void draw_times(const FrameTimes& times);
// One line at the top, in the middle of a scene so wide: something the user should know.
void draw_notice(const std::string& notice, double scene_width);

}  // namespace thimble
