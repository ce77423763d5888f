// The page that the subject's screen shows between two trials, and what the subject has said there: go on, or an answer.
#pragma once

#include <optional>
#include <utility>

#include "common/messages.hpp"

namespace thimble {

class SubjectPage {
  public:
    void show(const Page& page) {
        if (!page_ || page_->kind != page.kind || page_->trial != page.trial) *this = {};
        page_ = page;
    }
    void remove() { *this = {}; }
    const Page* shown() const { return page_ ? &*page_ : nullptr; }
    bool waits() const { return page_ && waits_to_go_on(page_->kind); }

    bool asks(std::uint32_t question) const {
        return page_ && page_->kind == PageKind::kQuestion && page_->trial == question;
    }

    void go_on() { go_on_ = true; }
    // Since the last call.
    bool take_go_on() { return std::exchange(go_on_, false); }
    void answer(double value) { answer_ = value; }
    std::optional<double> take_answer() { return std::exchange(answer_, std::nullopt); }

  private:
    std::optional<Page> page_;
    bool go_on_ = false;
    std::optional<double> answer_;  // to the question that is shown
};

}  // namespace thimble
