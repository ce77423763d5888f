#include "common/stop_bus.hpp"

#include <algorithm>
#include <limits>
#include <variant>

namespace thimble {
namespace {

// Saturates: a stop that is held for 49 days needs no exact age.
std::uint32_t whole_milliseconds(Duration time) {
    constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
    return static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(time / std::chrono::milliseconds{1}, 0, kMost));
}

bool may_release(Role role) { return role == Role::kSession || role == Role::kExperimenter; }

}  // namespace

// Takes all memory now: a tick takes none.
StopBus::StopBus(Role role, std::uint64_t instance)
    : role_(role), instance_(instance), out_(role, instance, {}) {
    releasing_.reserve(kHeld);
    held_.reserve(kHeld);
}

void StopBus::connect(Channel& in, const StopOutlets& out) {
    in_ = &in;
    out_ = OutboundFlow(role_, instance_, {out[0], out[1], out[2], out[3], out[4], out[5]});
}

void StopBus::hear_and_say(SessionTime now) {
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
        for (const std::uint64_t id : releasing_) repeat(now, id);
    }
    if (now >= next_passed_on_) {
        for (const Held& held : held_) out_.send(now, 0, held.order);
        next_passed_on_ = now + kStopPassedOn;
    }
    if (held_.empty()) next_passed_on_ = kNever;
    next_ = saying_ || releases_left_ > 0 ? std::min(now + kStopRepeat, next_passed_on_) : next_passed_on_;
}

// Accepts every sender and every sequence number: a stop must not be refused for either.
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
        if (sender == Role::kExperimenter) answer(now, order.id);
        return;
    }
    if (order.kind == StopKind::kAsk) return answer(now, order.id);
    if (may_release(sender)) return release_one(now, order.id);
    --counters_.accepted;
    ++counters_.refused[static_cast<std::size_t>(Refusal::kUnexpectedKind)];
}

void StopBus::hold(SessionTime now, Role sender, const StopOrder& order) {
    if (released(order.id)) return remind(now, order.id);
    if (find(order.id) != held_.end()) return;
    if (held_.size() == kHeld) make_room(now);
    if (held_.empty()) next_passed_on_ = now + kStopPassedOn;
    held_.push_back({order, sender, now});
    held_.back().order.held_ms = 0;
    next_ = std::min(next_, next_passed_on_);
}

bool StopBus::released(std::uint64_t id) const {
    const auto end = released_.begin() + static_cast<std::ptrdiff_t>(std::min(released_count_, kRemembered));
    return std::find(released_.begin(), end, id) != end;
}

// The list is full: the two newest stops become one with a new number, which no earlier release can name.
void StopBus::make_room(SessionTime now) {
    held_.pop_back();
    held_.back().order.id = new_id();
    held_.back().since = now;
}

// A second press in the meantime is a stop of its own: the release does not name it.
void StopBus::release_one(SessionTime now, std::uint64_t id) {
    if (!released(id)) released_[released_count_++ % kRemembered] = id;
    if (const auto found = find(id); found != held_.end()) {
        last_ = *found;
        held_.erase(found);
    }
    if (!saying_ || own_.id != id) return;
    saying_ = false;
    if (now < pressed_until_) say(now, own_.reason, own_.words());
}

// Repeats the release for a program that still holds the stop: it has missed the release.
void StopBus::remind(SessionTime now, std::uint64_t id) {
    if (!may_release(role_) || now < next_reminder_) return;
    next_reminder_ = now + kStopRepeat;
    repeat(now, id);
}

void StopBus::repeat(SessionTime now, std::uint64_t release) {
    out_.send(now, 0, StopOrder(release, StopKind::kRelease, EndReason::kEmergencyStop, {}));
}

void StopBus::answer(SessionTime now, std::uint64_t id) {
    if (now < next_answer_) return;
    next_answer_ = now + kAnswerEvery;
    for (const Held& held : held_) {
        StopOrder order = held.order;
        order.held_ms = whole_milliseconds(now - held.since);
        const Header header{instance_, now, ++answers_, number_in_answer(id), role_};
        in_->answer(encoder_.encode(header, order));
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
    releasing_.clear();
    for (const Held& held : held_) {
        if (now - held.since >= kHeldAtLeast) releasing_.push_back(held.order.id);
    }
    for (const std::uint64_t id : releasing_) release_one(now, id);
    releases_left_ = releasing_.empty() ? 0 : kReleaseTimes;
    next_ = now;
    tick(now);
}

// Different between programs by their instance, within one by the count.
std::uint64_t StopBus::new_id() {
    return (instance_ ^ (++made_ * 0x9E3779B97F4A7C15ULL)) + static_cast<std::uint64_t>(role_);
}

}  // namespace thimble
