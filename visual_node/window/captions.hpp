// The scene over the tissue, text, and the pages between trials, by Dear ImGui's draw lists. Call the draw_ functions between
// GuiLayer::begin() and end().
#pragma once

#include <string>

#include "common/messages.hpp"
#include "visual_node/instructions.hpp"
#include "visual_node/window/cutaway.hpp"
#include "visual_node/window/frame_times.hpp"
#include "visual_node/window/gui_layer.hpp"
#include "visual_node/window/picture.hpp"

namespace thimble {

// The text for a subject between trials. Never the modality's name, never anything of the fixture, unless a lab's own words do.
struct PageText {
    std::string title;
    std::string body;  // lines; may be empty
};

// Empty for kNone.
PageText page_text(const Page& page);
// With a lab's own words where it has some. `subject_goes_on`: a page that waits says how, if it has our text or the lab says how.
PageText page_text(const Page& page, const Instructions& instructions, bool subject_goes_on);
// In place of a question of another page set than the window's own.
PageText unknown_question(const Page& page);

// Needle, bar with its scale, and fingertip, over the tissue that Painter has painted.
void draw_over_tissue(const Picture& picture);
// Labels over the cut-away view.
void draw_over_cutaway(const Scene& scene, const CutawayPlan& plan);
// A line at the top left, where the needle never is.
void draw_headline(const std::string& text, const CutawayPlan& plan);
// Darkens a scene so wide; `opacity` 1: covers it.
void draw_shade(double scene_width, double opacity);
// Covers a scene so wide, and no panel beside it; `opacity` 1: wholly. Lines too long for it are broken between words.
void draw_page(const GuiLayer& gui, const PageText& text, double scene_width, double opacity = 1);
// A box in the middle.
void draw_key_help(const std::string& keys);
// One line at the bottom left: how old what is seen is.
void draw_times(const FrameTimes& times);
// One line at the top, in the middle of a scene so wide: something the user should know.
void draw_notice(const std::string& notice, double scene_width);

}  // namespace thimble
