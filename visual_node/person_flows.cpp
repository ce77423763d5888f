#include "visual_node/person_flows.hpp"

#include <cassert>

namespace thimble {

HandFlow::HandFlow(std::uint64_t instance, Channel* out, HandSource* hand)
    : flow_(Role::kVisual, instance, {out}), hand_(hand) {
    assert((out == nullptr) == (hand == nullptr));
}

void HandFlow::start_trial() {
    if (hand_ == nullptr) return;
    hand_->home();
    said_any_ = false;
    next_look_ = {};
}

void HandFlow::work(SessionTime now, bool running, std::uint32_t trial) {
    if (hand_ == nullptr || !running) {
        next_look_ = kNever;
        return;
    }
    if (now < next_look_) return;
    next_look_ = now + kPeriod;
    const HandInput hand = hand_->hand();
    if (!news(hand) && now - said_at_ < kSignOfLife) return;
    flow_.send(now, trial, hand);
    said_ = hand;
    said_at_ = now;
    said_any_ = true;
}

bool HandFlow::news(const HandInput& hand) const {
    return !said_any_ || hand.engaged != said_.engaged || hand.position_hand_m != said_.position_hand_m;
}

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
