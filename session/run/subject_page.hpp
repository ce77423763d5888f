// The page that the subject's screen shows between two trials, and whether the subject has asked to go on from it.
#pragma once

#include <optional>
#include <utility>

#include "common/messages.hpp"

namespace thimble {

class SubjectPage {
  public:
    void show(const Page& page) {
        if (!page_ || page_->kind != page.kind || page_->trial != page.trial) go_on_ = false;
        page_ = page;
    }
    void remove() { *this = {}; }
    const Page* shown() const { return page_ ? &*page_ : nullptr; }
    bool waits() const { return page_ && waits_to_go_on(page_->kind); }

    void go_on() { go_on_ = true; }
    // Since the last call.
    bool take_go_on() { return std::exchange(go_on_, false); }

  private:
    std::optional<Page> page_;
    bool go_on_ = false;
};

}  // namespace thimble
