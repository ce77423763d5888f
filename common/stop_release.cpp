#include "common/stop_release.hpp"

#include <algorithm>
#include <variant>

namespace thimble {

StopRelease::StopRelease(std::uint64_t instance, const StopOutlets& at)
    : at_(at), out_(Role::kExperimenter, instance, {at[0], at[1], at[2], at[3], at[4], at[5]}) {
    stops_.reserve(kMostStops);
}

void StopRelease::round(SessionTime now) {
    for (Channel* channel : at_) hear(*channel);
    if (rounds_++ < kAskTimes) out_.send(now, 0, StopOrder(0, StopKind::kAsk, EndReason::kEmergencyStop, {}));
    for (const StopOrder& stop : stops_)
        out_.send(now, 0, StopOrder(stop.id, StopKind::kRelease, EndReason::kEmergencyStop, {}));
}

void StopRelease::hear(Channel& channel) {
    for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
        const Bytes in = channel.receive();
        if (in.empty()) return;
        if (decode_into(in, message_) != Refusal::kCount) continue;
        const auto* order = std::get_if<StopOrder>(&message_.body);
        if (order != nullptr && order->kind == StopKind::kStop) note(*order);
    }
}

void StopRelease::note(const StopOrder& stop) {
    const bool known = std::any_of(stops_.begin(), stops_.end(),
                                   [&stop](const StopOrder& other) { return other.id == stop.id; });
    if (!known && stops_.size() < kMostStops) stops_.push_back(stop);
}

}  // namespace thimble
