#include "session/play/session_observer.hpp"

#include <variant>

#include "common/runtime/wall_clock.hpp"

namespace thimble {

void OrderTaker::tick(SessionTime now, std::uint32_t trial) {
    while (const Message* message = flow_.receive(now, *in_)) {
        const auto* order = std::get_if<Order>(&message->body);
        const std::optional<Refusal> refusal = order == nullptr
                                                   ? std::optional{Refusal::kUnexpectedKind}
                                                   : judge(now, message->header.trial, trial, *order);
        if (refusal) flow_.refuse_admitted(*refusal);
    }
}

std::optional<Refusal> OrderTaker::judge(SessionTime now, std::uint32_t asked_for, std::uint32_t trial,
                                         const Order& order) {
    switch (order.kind) {
        case OrderKind::kStart:
        case OrderKind::kEndTrial:
            if (asked_for != trial) return Refusal::kWrongTrial;
            break;
        case OrderKind::kRepeat:
        case OrderKind::kExclude:
            // Only the newest trial can be judged, as by what is typed.
            if (order.trial != trial) return Refusal::kWrongTrial;
            if (said_again(now, order.kind == OrderKind::kRepeat ? repeat_ : exclude_, trial))
                return std::nullopt;
            break;
        default:
            break;
    }
    return handler_->obey(now, order);
}

bool OrderTaker::said_again(SessionTime now, Request& request, std::uint32_t trial) {
    const bool again = request.said && request.trial == trial && now - request.last <= kSameRequest;
    request = {trial, now, true};
    return again;
}

SessionObserver::SessionObserver(std::uint64_t instance, const SessionProcess& session,
                                 const ViewChannels& channels, OrderHandler& handler,
                                 const MonitorContext& context)
    : session_(&session),
      context_(&context),
      feed_(instance, {channels.experimenter_monitor, channels.player_monitor}, session),
      experimenter_(*channels.experimenter_orders, handler),
      player_(*channels.player_orders, handler) {}

void SessionObserver::tick(SessionTime now) {
    experimenter_.tick(now, session_->number());
    player_.tick(now, session_->number());
    feed_.tick(now, *context_);
}

ViewChannels open_view_channels(Sockets& sockets) {
    Channel* const experimenter = sockets.between(Port::kSessionOrders, Port::kExperimenterMonitor);
    Channel* const player = sockets.between(Port::kSessionPlayerOrders, Port::kPlayerMonitor);
    return {experimenter, experimenter, player, player};
}

std::unique_ptr<Process> make_observer(const SessionProcess& session, Sockets& sockets, OrderHandler& handler,
                                       const MonitorContext& context) {
    return std::make_unique<SessionObserver>(system_entropy(), session, open_view_channels(sockets), handler,
                                             context);
}

}  // namespace thimble
