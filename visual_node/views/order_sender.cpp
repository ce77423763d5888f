#include "visual_node/views/order_sender.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

// Doubles travel unchanged, but a session may keep a delay in whole nanoseconds.
constexpr double kDelayResolution_s = 1e-6;
// A replay that runs goes on from where it was sent: so far it may have come, at speed 1, before its Monitor is seen.
constexpr double kSeekResolution_s = 0.5;

bool sought(double time_s, const SessionView& session) {
    const double resolution_s =
        session.monitor.paused ? kDelayResolution_s : kSeekResolution_s * std::max(1.0, session.replay_speed);
    return std::abs(session.monitor.time_s - time_s) < resolution_s;
}

bool has_delay(const Monitor& monitor, double delay_s) {
    return std::abs(monitor.network_delay_s - delay_s) < kDelayResolution_s;
}

bool shown_anywhere(OrderKind kind) {
    return kind != OrderKind::kRepeat && kind != OrderKind::kExclude && kind != OrderKind::kSpeed;
}

}  // namespace

OrderSender::OrderSender(std::uint64_t instance, Channel& channel)
    : flow_(Role::kExperimenter, instance, {&channel}) {}

void OrderSender::call_off(OrderKind kind) {
    Asked& asked = at(kind);
    if (asked.progress == OrderProgress::kAsking) asked.progress = OrderProgress::kNone;
}

void OrderSender::ask(SessionTime now, const Order& order, const SessionView& session) {
    if (order.kind == OrderKind::kPause) call_off(OrderKind::kResume);
    if (order.kind == OrderKind::kResume) call_off(OrderKind::kPause);
    if (order.kind == OrderKind::kStart) call_off(OrderKind::kEndTrial);
    if (order.kind == OrderKind::kEndTrial) call_off(OrderKind::kStart);
    if (order.kind == OrderKind::kDelay) call_off(OrderKind::kNetwork);
    if (order.kind == OrderKind::kNetwork) call_off(OrderKind::kDelay);
    unanswered_ = nullptr;
    Asked& asked = at(order.kind);
    asked = {order, session.trial, now, now, 0, OrderProgress::kAsking};
    say(now, asked);
}

// With the trial for which it was asked: a session can tell that an EndTrial was overtaken by the next trial.
void OrderSender::say(SessionTime now, Asked& asked) {
    flow_.send(now, asked.trial, asked.order);
    asked.next = now + kOrderRepeat;
    ++asked.times;
}

bool OrderSender::shows(const Asked& asked, const SessionView& session) {
    const Monitor& monitor = session.monitor;
    const bool running = monitor.state == NodeState::kRunning;
    switch (asked.order.kind) {
        case OrderKind::kDelay:
            return has_delay(monitor, asked.order.value);
        case OrderKind::kNetwork:
            return monitor.network == asked.order.network && has_delay(monitor, asked.order.value);
        case OrderKind::kStart:
            // Only free play, which has no plan, begins the modality that was asked for.
            return running && session.trial != asked.trial &&
                   (monitor.trials > 0 || monitor.modality == asked.order.modality);
        case OrderKind::kPause:
            return monitor.paused;
        case OrderKind::kResume:
            return !monitor.paused;
        case OrderKind::kEndTrial:
            return !running || session.trial != asked.trial;
        case OrderKind::kSeek:
            return sought(asked.order.value, session);
        default:
            return false;
    }
}

void OrderSender::step(SessionTime now, Asked& asked, const SessionView& session) {
    // Old messages of a session that has fallen silent prove nothing. The silence proves that it has quit.
    const bool quit = asked.order.kind == OrderKind::kQuit;
    if (now - asked.since < kOrderRepeat) return;
    if (quit ? session.silent : !session.silent && shows(asked, session)) {
        asked.progress = OrderProgress::kShown;
        unanswered_ = nullptr;
    } else if (!shown_anywhere(asked.order.kind) && asked.times >= kUnseenOrderTimes) {
        asked.progress = OrderProgress::kSent;
    } else if (now - asked.since >= kOrderPatience) {
        asked.progress = OrderProgress::kUnanswered;
        unanswered_ = &asked.order;
    } else if (now >= asked.next) {
        say(now, asked);
    }
}

void OrderSender::update(SessionTime now, const SessionView& session) {
    for (Asked& asked : asked_) {
        if (asked.progress == OrderProgress::kAsking) step(now, asked, session);
    }
}

bool OrderSender::asking() const {
    return std::any_of(asked_.begin(), asked_.end(),
                       [](const Asked& asked) { return asked.progress == OrderProgress::kAsking; });
}

const char* to_string(OrderKind kind) {
    static constexpr std::array kNames{"delay",  "start",   "pause", "resume", "end trial", "quit",
                                       "repeat", "exclude", "seek",  "speed",  "network"};
    return kNames.at(static_cast<std::size_t>(kind));
}

}  // namespace thimble
