#include "visual_node/hand_flow.hpp"

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

}  // namespace thimble
