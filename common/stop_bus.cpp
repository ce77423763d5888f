#include "common/stop_bus.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <variant>

namespace thimble {
namespace {

// Years are as long as it needs to be.
std::uint32_t whole_milliseconds(Duration time) {
    constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
    return static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(time / std::chrono::milliseconds{1}, 0, kMost));
}

bool may_release(Role role) { return role == Role::kSession || role == Role::kExperimenter; }

}  // namespace

void StopBus::connect(Channel& in, const StopOutlets& out) {
    in_ = &in;
    out_ = OutboundFlow(role_, instance_, {out[0], out[1], out[2], out[3], out[4], out[5]});
}

void StopBus::tick(SessionTime now) {
    if (in_ != nullptr && !in_->known_empty()) {
        for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
            const Bytes in = in_->receive();
            if (in.empty()) break;
            take(now, in);
        }
    }
    if (now >= next_) say_what_is_due(now);
}

void StopBus::say_what_is_due(SessionTime now) {
    if (saying_) out_.send(now, 0, own_);
    if (releases_left_ > 0) {
        --releases_left_;
        for (std::size_t i = 0; i < releasing_count_; ++i)
            out_.send(now, 0, StopOrder(releasing_[i], StopKind::kRelease, EndReason::kEmergencyStop, {}));
    }
    if (now >= next_passed_on_) {
        for (std::size_t i = 0; i < held_count_; ++i) out_.send(now, 0, held_[i].order);
        next_passed_on_ = now + kStopPassedOn;
    }
    if (held_count_ == 0) next_passed_on_ = kNever;
    next_ = saying_ || releases_left_ > 0 ? std::min(now + kStopRepeat, next_passed_on_) : next_passed_on_;
}

// From any sender, with any number: a stop must not be refused because of its sender.
void StopBus::take(SessionTime now, Bytes datagram) {
    std::optional<Refusal> refusal = decode_into(datagram, message_);
    const auto* order = !refusal ? std::get_if<StopOrder>(&message_.body) : nullptr;
    if (!refusal && order == nullptr) refusal = Refusal::kUnexpectedKind;
    if (refusal) {
        ++counters_.refused[static_cast<std::size_t>(*refusal)];
        return;
    }
    ++counters_.accepted;
    obey(now, message_.header.sender, *order);
}

void StopBus::obey(SessionTime now, Role sender, const StopOrder& order) {
    if (order.kind == StopKind::kStop) {
        hold(now, sender, order);
        // A stop from outside is answered at once: a session that it ends may be gone when the question comes.
        if (sender == Role::kExperimenter) answer(now);
        return;
    }
    if (order.kind == StopKind::kAsk) return answer(now);
    if (may_release(sender)) return let_go(now, order.id);
    --counters_.accepted;
    ++counters_.refused[static_cast<std::size_t>(Refusal::kUnexpectedKind)];
}

void StopBus::hold(SessionTime now, Role sender, const StopOrder& order) {
    if (released(order.id)) return remind(now, order.id);
    if (holds(order.id)) return;
    if (held_count_ == kHeld) make_room(now);
    if (held_count_ == 0) next_passed_on_ = now + kStopPassedOn;
    held_[held_count_] = {order, sender, now};
    held_[held_count_++].order.held_ms = 0;
    next_ = std::min(next_, next_passed_on_);
}

// More at once than there are places: the two newest become one with a number of its own, which no release that was made before
// can name.
void StopBus::make_room(SessionTime now) {
    --held_count_;
    Held& last = held_[held_count_ - 1];
    last.order.id = new_id();
    last.since = now;
}

// A second press meanwhile is another stop, which the release did not know.
void StopBus::let_go(SessionTime now, std::uint64_t id) {
    if (!released(id)) remember(id);
    drop(id);
    if (!saying_ || own_.id != id) return;
    saying_ = false;
    if (now < pressed_until_) say(now, own_.reason, own_.words());
}

void StopBus::drop(std::uint64_t id) {
    const auto end = held_.begin() + static_cast<std::ptrdiff_t>(held_count_);
    const auto found =
        std::find_if(held_.begin(), end, [id](const Held& held) { return held.order.id == id; });
    if (found == end) return;
    std::copy(found + 1, end, found);
    --held_count_;
}

// A program still holds or repeats a released stop: the release has not reached it.
void StopBus::remind(SessionTime now, std::uint64_t id) {
    if (!may_release(role_) || now < next_reminder_) return;
    next_reminder_ = now + kStopRepeat;
    out_.send(now, 0, StopOrder(id, StopKind::kRelease, EndReason::kEmergencyStop, {}));
}

void StopBus::answer(SessionTime now) {
    if (now < next_answer_) return;
    next_answer_ = now + kAnswerEvery;
    for (std::size_t i = 0; i < held_count_; ++i) {
        StopOrder held = held_[i].order;
        held.held_ms = whole_milliseconds(now - held_[i].since);
        in_->answer(encoder_.encode(Header{instance_, now, ++answers_, 0, role_}, held));
    }
}

void StopBus::stop(SessionTime now, EndReason reason, std::string_view words) {
    if (saying_) {
        if (reason == EndReason::kEmergencyStop) pressed_until_ = now + kPressedLately;
        return;
    }
    say(now, reason, words);
    tick(now);
}

void StopBus::say(SessionTime now, EndReason reason, std::string_view words) {
    own_ = StopOrder(new_id(), StopKind::kStop, reason, words);
    saying_ = true;
    pressed_until_ = {};
    hold(now, role_, own_);
    next_ = now;
}

void StopBus::release(SessionTime now) {
    releasing_count_ = 0;
    for (std::size_t i = 0; i < held_count_; ++i) {
        if (now - held_[i].since >= kHeldAtLeast) releasing_[releasing_count_++] = held_[i].order.id;
    }
    for (std::size_t i = 0; i < releasing_count_; ++i) let_go(now, releasing_[i]);
    releases_left_ = releasing_count_ == 0 ? 0 : kReleaseTimes;
    next_ = now;
    tick(now);
}

bool StopBus::holds(std::uint64_t id) const {
    const auto end = held_.begin() + static_cast<std::ptrdiff_t>(held_count_);
    return std::any_of(held_.begin(), end, [id](const Held& held) { return held.order.id == id; });
}

bool StopBus::released(std::uint64_t id) const {
    const auto end = done_.begin() + static_cast<std::ptrdiff_t>(done_count_);
    return std::find(done_.begin(), end, id) != end;
}

void StopBus::remember(std::uint64_t id) {
    done_[done_next_] = id;
    done_next_ = (done_next_ + 1) % done_.size();
    done_count_ = std::min(done_count_ + 1, done_.size());
}

// Different between programs by their instance, within one by the count.
std::uint64_t StopBus::new_id() {
    return (instance_ ^ (++made_ * 0x9E3779B97F4A7C15ULL)) + static_cast<std::uint64_t>(role_);
}

}  // namespace thimble
