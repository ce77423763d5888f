// The page between two trials, and the answer to the question on it: what is shown, and what a subject's keys do there.
#pragma once

#include <string>
#include <vector>

#include "visual_node/page_set.hpp"
#include "visual_node/question_form.hpp"
#include "visual_node/window/captions.hpp"
#include "visual_node/window/gui_layer.hpp"

namespace thimble {

class WindowDisplay;

class PageView {
  public:
    // Both may be null, and outlive this. Without pages the view has the program's words; without a display it gives no answer.
    PageView(const PageSet* pages, WindowDisplay* display);

    // Whether the page asks a question that this window can show. The session's page set may be another one: that is logged.
    bool turn_to(const Page& page);
    const Page& page() const { return page_; }
    bool shown() const { return page_.kind != PageKind::kNone; }
    bool asks() const { return form_.question() != nullptr; }

    // Whether the key was meant for the question that is shown.
    bool take_key(int key);
    // `beside_panel`: the panel of a view says what to do, so only a lab's own text remains.
    PageText text(bool subject_goes_on, bool beside_panel) const;
    // The question over a scene so wide. `how`: how to answer.
    void draw_question(const GuiLayer& gui, const std::string& how, double scene_width);

  private:
    void give_answer();

    const PageSet* pages_;
    WindowDisplay* display_;
    std::vector<ShownQuestion> questions_;
    std::uint32_t checksum_ = 0;  // of the page set
    Page page_;
    QuestionForm form_;
};

// A window shows questions and their answers beside the scene, and the beep as a bright frame. Between GuiLayer::begin() and end().

// Over a scene so wide. The mouse chooses in `form`. True: OK was clicked.
bool draw_question(const GuiLayer& gui, const ShownQuestion& question, QuestionForm& form,
                   const std::string& how, double scene_width);

// How long the frame of a beep is seen.
inline constexpr Duration kBeepSeen = std::chrono::milliseconds{600};
void draw_beep(double scene_width);

}  // namespace thimble
