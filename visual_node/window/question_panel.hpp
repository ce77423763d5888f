// A window shows a subject these beside the scene and the pages: questions with their answers, and the beep as a bright frame.
// Call these between GuiLayer::begin() and end().
#pragma once

#include <string>

#include "visual_node/question_form.hpp"
#include "visual_node/window/gui_layer.hpp"

namespace thimble {

// Over a scene so wide. The mouse chooses in `form`. True: OK was clicked.
bool draw_question(const GuiLayer& gui, const ShownQuestion& question, QuestionForm& form,
                   const std::string& how, double scene_width);

// How long the frame of a beep is seen.
inline constexpr Duration kBeepSeen = std::chrono::milliseconds{600};
void draw_beep(double scene_width);

}  // namespace thimble
