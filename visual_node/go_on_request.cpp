#include "visual_node/go_on_request.hpp"

namespace thimble {

void GoOnRequest::turn(SessionTime now, const Page& page) {
    if (page.kind == kind_ && page.trial == trial_) return;
    kind_ = page.kind;
    trial_ = page.trial;
    wanted_ = false;
    next_look_ = enabled_ && waits_to_go_on(kind_) ? now : kNever;
}

void GoOnRequest::press(SessionTime now) {
    if (next_look_ == kNever || wanted_) return;
    wanted_ = true;
    next_saying_ = now;
    until_ = now + kPatience;
}

bool GoOnRequest::take_due(SessionTime now) {
    if (next_look_ == kNever) return false;
    next_look_ = now + kLook;
    if (wanted_ && now >= until_) wanted_ = false;
    if (!wanted_ || now < next_saying_) return false;
    next_saying_ = now + kRepeat;
    return true;
}

}  // namespace thimble
