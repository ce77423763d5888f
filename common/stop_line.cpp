#include "common/stop_line.hpp"

#include <algorithm>
#include <variant>

namespace thimble {

void StopLine::connect(Channel& in, const StopOutlets& out) {
    in_ = &in;
    out_ = OutboundFlow(role_, instance_, {out[0], out[1], out[2], out[3], out[4], out[5]});
}

void StopLine::tick(SessionTime now) {
    if (in_ != nullptr && !in_->known_empty()) {
        for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
            const Bytes in = in_->receive();
            if (in.empty()) break;
            take(now, in);
        }
    }
    if (now < next_) return;
    next_ = kNever;
    if (saying_) out_.send(now, 0, own_);
    if (releases_left_ > 0) {
        --releases_left_;
        out_.send(now, 0, own_release_);
    }
    if (saying_ || releases_left_ > 0) next_ = now + kStopRepeat;
}

// Whoever it is, and however old its number: a stop that is refused for its sender's sake is none.
void StopLine::take(SessionTime now, Bytes datagram) {
    Refusal refusal = decode_into(datagram, message_);
    const auto* order = refusal == Refusal::kCount ? std::get_if<StopOrder>(&message_.body) : nullptr;
    if (refusal == Refusal::kCount && order == nullptr) refusal = Refusal::kUnexpectedKind;
    if (refusal != Refusal::kCount) {
        ++counters_.refused[static_cast<std::size_t>(refusal)];
        return;
    }
    ++counters_.accepted;
    obey(now, message_.header.sender, *order);
}

void StopLine::obey(SessionTime now, Role sender, const StopOrder& order) {
    if (order.kind == StopKind::kStop) return hold(now, sender, order);
    if (sender == Role::kSession || sender == Role::kExperimenter) return let_go(now, order.id);
    --counters_.accepted;
    ++counters_.refused[static_cast<std::size_t>(Refusal::kUnexpectedKind)];
}

// With as many at once as there are places, the newest needs none of its own: one release lets go of all.
void StopLine::hold(SessionTime now, Role sender, const StopOrder& order) {
    if (released(order.id) || holds(order.id) || held_count_ == kHeld) return;
    held_[held_count_++] = {order, sender, now};
}

void StopLine::let_go(SessionTime now, std::uint64_t release) {
    if (released(release)) return;
    remember(release);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < held_count_; ++i) {
        if (now - held_[i].since < kHeldAtLeast) {
            held_[kept++] = held_[i];
        } else {
            remember(held_[i].order.id);
        }
    }
    held_count_ = kept;
    saying_ = saying_ && holds(own_.id);
}

void StopLine::stop(SessionTime now, EndReason reason, std::string_view words) {
    if (saying_) return;
    own_ = StopOrder(new_id(), StopKind::kStop, reason, words);
    saying_ = true;
    releases_left_ = 0;
    if (held_count_ == kHeld) --held_count_;  // one's own has a place in any case
    hold(now, role_, own_);
    next_ = now;
    tick(now);
}

void StopLine::release(SessionTime now) {
    own_release_ = StopOrder(new_id(), StopKind::kRelease, EndReason::kEmergencyStop, {});
    let_go(now, own_release_.id);
    releases_left_ = kReleaseTimes;
    next_ = now;
    tick(now);
}

bool StopLine::holds(std::uint64_t id) const {
    const auto end = held_.begin() + static_cast<std::ptrdiff_t>(held_count_);
    return std::any_of(held_.begin(), end, [id](const Held& held) { return held.order.id == id; });
}

bool StopLine::released(std::uint64_t id) const {
    return std::find(done_.begin(), done_.end(), id) != done_.end();
}

void StopLine::remember(std::uint64_t id) {
    done_[done_next_] = id;
    done_next_ = (done_next_ + 1) % done_.size();
}

// Different between programs by their instance, within one by the count; never the 0 of an empty place.
std::uint64_t StopLine::new_id() {
    const std::uint64_t id =
        (instance_ ^ (++made_ * 0x9E3779B97F4A7C15ULL)) + static_cast<std::uint64_t>(role_);
    return id == 0 ? 1 : id;
}

}  // namespace thimble
