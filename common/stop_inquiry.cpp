#include "common/stop_inquiry.hpp"

#include <algorithm>
#include <variant>

namespace thimble {

void StopInquiry::ask(SessionTime now) {
    if (begun_ == kNever) begun_ = now;
    out_->send(now, 0, StopOrder(0, StopKind::kAsk, EndReason::kEmergencyStop, {}));
}

void StopInquiry::hear(SessionTime now) {
    if (begun_ == kNever) begun_ = now;
    for (Channel* channel : at_) hear(now, *channel);
}

void StopInquiry::hear(SessionTime now, Channel& channel) {
    for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
        const Bytes in = channel.receive();
        if (in.empty()) return;
        if (decode_into(in, message_)) continue;
        const auto* order = std::get_if<StopOrder>(&message_.body);
        if (order == nullptr || order->kind != StopKind::kStop) continue;
        // It had been held for so long when it was answered, which was before now.
        const Duration held = std::chrono::milliseconds{order->held_ms};
        note({message_.header.sender, *order, held >= std::max<Duration>(kHeldAtLeast, now - begun_)});
    }
}

void StopInquiry::note(const LatchedStop& answer) {
    const auto known = std::find_if(held_.begin(), held_.end(), [&answer](const LatchedStop& other) {
        return other.by == answer.by && other.stop.id == answer.stop.id;
    });
    if (known != held_.end()) {
        known->since_before = known->since_before || answer.since_before;
    } else if (held_.size() < kMostAnswers) {
        held_.push_back(answer);
    }
}

void StopRelease::round(SessionTime now) {
    inquiry_.hear(now);
    if (rounds_++ < kAskTimes) inquiry_.ask(now);
    for (const LatchedStop& held : inquiry_.held()) {
        const bool known = std::any_of(stops_.begin(), stops_.end(),
                                       [&held](const StopOrder& other) { return other.id == held.stop.id; });
        if (held.since_before && !known) stops_.push_back(held.stop);
    }
    for (const StopOrder& stop : stops_)
        out_.send(now, 0, StopOrder(stop.id, StopKind::kRelease, EndReason::kEmergencyStop, {}));
}

}  // namespace thimble
