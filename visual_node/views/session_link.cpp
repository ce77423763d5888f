#include "visual_node/views/session_link.hpp"

#include <algorithm>

#include "visual_node/views/commands.hpp"
#include "visual_node/views/monitor_text.hpp"

namespace thimble {

SessionLink::SessionLink(std::uint64_t instance, const Channels& channels, double window_s)
    : receiver_(*channels.monitor_in), history_(window_s), orders_(instance, *channels.orders_out) {}

SessionView SessionLink::seen(SessionTime now) const {
    return {receiver_.newest(), receiver_.trial(), receiver_.silent(now)};
}

void SessionLink::update(SessionTime now) {
    receiver_.update(now, [this](SessionTime at, std::uint32_t trial, const Monitor& monitor) {
        history_.add(at, trial, monitor);
    });
    orders_.update(now, seen(now));
}

void SessionLink::ask(SessionTime now, const Order& order) { orders_.ask(now, order, seen(now)); }

double SessionLink::delay_s() const {
    const bool asking = orders_.progress(OrderKind::kDelay) == OrderProgress::kAsking;
    return asking ? orders_.asked(OrderKind::kDelay).value : monitor().network_delay_s;
}

void SessionLink::ask_delay(SessionTime now, double delay_s) {
    Order order;
    order.kind = OrderKind::kDelay;
    order.value = std::clamp(delay_s, 0.0, kDelayLimit_s);
    ask(now, order);
}

bool SessionLink::running(SessionTime now) const {
    return !receiver_.silent(now) && monitor().state == NodeState::kRunning;
}

TextLine SessionLink::alarm(SessionTime now) const {
    if (!receiver_.heard()) return TextLine::of("No session has spoken yet. Waiting for one.");
    if (receiver_.silent(now)) {
        return TextLine::of("The session is silent, for {} now. What you see is old.",
                            age_text(receiver_.age(now)).view());
    }
    if (const Order* order = orders_.unanswered()) {
        return TextLine::of("The session does not answer: '{}' was asked for {} s.", to_string(order->kind),
                            to_seconds(kOrderPatience));
    }
    return {};
}

}  // namespace thimble
