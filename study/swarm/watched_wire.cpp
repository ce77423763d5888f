#include <algorithm>
#include <array>

#include "study/swarm/watched_parts.hpp"

namespace thimble {
namespace {

constexpr std::size_t kShuffled = 4;
// Where a message must begin.
using Aligned = std::array<std::uint8_t, kMaxDatagramBytes>;

Bytes aligned_copy(Bytes bytes, Aligned& place) {
    std::copy(bytes.begin(), bytes.end(), place.begin());
    return {place.data(), bytes.size()};
}

}  // namespace

void WatchedWire::send(Bytes datagram) {
    watch_->sent(to_, datagram);
    const auto mine = std::find_if(active_->begin(), active_->end(), [this](const SwarmFault* fault) {
        return of_wire(fault->kind) && fault->port == to_;
    });
    if (mine != active_->end()) return suffer(**mine, datagram);
    if (!kept_.empty()) pass_kept();
    pass(datagram);
}

void WatchedWire::suffer(const SwarmFault& fault, Bytes datagram) {
    switch (fault.kind) {
        case FaultKind::kLoss:
            if (draw_->uniform() >= fault.value) pass(datagram);
            return;
        case FaultKind::kDouble:
            pass(datagram);
            return pass(datagram);
        case FaultKind::kReorder:
            keep(datagram);
            if (kept_.size() < kShuffled) return;
            std::reverse(kept_.begin(), kept_.end());
            return pass_kept();
        case FaultKind::kLate:
            keep(datagram);
            return pass_late(from_seconds(2 * fault.value));
        case FaultKind::kClock:
            return put_stamp_off(datagram, fault.value < 0.5);
        case FaultKind::kCorrupt:
            return flip(datagram);
        default:
            return;  // cut
    }
}

void WatchedWire::pass(Bytes datagram) {
    watch_->arrived(to_, datagram);
    inner_->send(datagram);
}

void WatchedWire::pass_kept() {
    alignas(16) Aligned place{};
    for (const Kept& kept : kept_) pass(aligned_copy(kept.bytes, place));
    kept_.clear();
}

// When the next one comes.
void WatchedWire::pass_late(Duration by) {
    alignas(16) Aligned place{};
    for (; !kept_.empty() && *now_ - kept_.front().since >= by; kept_.pop_front())
        pass(aligned_copy(kept_.front().bytes, place));
}

void WatchedWire::flip(Bytes datagram) {
    alignas(16) Aligned place{};
    const Bytes copy = aligned_copy(datagram, place);
    const auto at = draw_->below(static_cast<std::uint32_t>(copy.size()));
    place.at(at) = static_cast<std::uint8_t>(place.at(at) ^ (1U << draw_->below(8)));
    pass(copy);
}

void WatchedWire::put_stamp_off(Bytes datagram, bool back) {
    Decoded decoded = decode(datagram);
    if (!decoded.message) return;
    decoded.message->header.send_time += std::chrono::hours{back ? -1 : 1};
    pass(encoder_.encode(*decoded.message));
}

}  // namespace thimble
