#include "visual_node/window/page_view.hpp"

#include <spdlog/spdlog.h>

#include "visual_node/window/window_display.hpp"
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

namespace thimble {

PageView::PageView(const PageSet* pages, WindowDisplay* display) : pages_(pages), display_(display) {
    if (pages == nullptr) return;
    questions_ = pages->shown();
    checksum_ = pages->checksum();
}

// The session reads its page set, and this window its own: a question with the same number may have other words.
bool PageView::turn_to(const Page& page) {
    const bool question = page.kind == PageKind::kQuestion;
    const bool known = page.trials == checksum_ && page.trial >= 1 && page.trial <= questions_.size();
    if (question && !known && !(page == page_)) spdlog::warn(unknown_question(page).body);
    page_ = page;
    form_.show(page.trial, question && known ? &questions_[page.trial - 1].question : nullptr);
    return asks();
}

bool PageView::take_key(int key) {
    if (!asks()) return false;
    const bool list = form_.question()->kind == QuestionKind::kChoice;  // it goes downwards
    const bool number = form_.question()->kind == QuestionKind::kNumber;
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return form_.type(key - GLFW_KEY_0), true;
    if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return form_.type(key - GLFW_KEY_KP_0), true;
    switch (key) {
        case GLFW_KEY_LEFT:
        case GLFW_KEY_RIGHT:
            return form_.move(key == GLFW_KEY_RIGHT ? 1 : -1), true;
        case GLFW_KEY_UP:
        case GLFW_KEY_DOWN:
            return form_.move((key == GLFW_KEY_DOWN) == list ? 1 : -1), true;
        case GLFW_KEY_PAGE_UP:
        case GLFW_KEY_PAGE_DOWN:
            return form_.turn_pages(key == GLFW_KEY_PAGE_DOWN ? 1 : -1), true;
        case GLFW_KEY_BACKSPACE:  // a digit too many stops no session; no trial runs, and no force acts
            return number && (form_.clear(), true);
        case GLFW_KEY_DELETE:
            return form_.clear(), true;
        case GLFW_KEY_ENTER:
        case GLFW_KEY_KP_ENTER:
            return give_answer(), true;
        default:
            return false;
    }
}

void PageView::give_answer() {
    const auto given = form_.given();
    if (given && display_ != nullptr) display_->answer(*given);
}

PageText PageView::text(bool subject_goes_on, bool beside_panel) const {
    static const Instructions kUnchanged;
    const Instructions& words = pages_ == nullptr ? kUnchanged : pages_->instructions;
    if (page_.kind == PageKind::kQuestion && !asks()) return unknown_question(page_);
    PageText text = page_text(page_, words, subject_goes_on);
    if (beside_panel && !words.of(page_.kind).body) text.body.clear();
    return text;
}

void PageView::draw_question(const GuiLayer& gui, const std::string& how, double scene_width) {
    if (thimble::draw_question(gui, questions_[page_.trial - 1], form_, how, scene_width)) give_answer();
}

}  // namespace thimble
