#include "session/play/session_observer.hpp"

#include "common/runtime/wall_clock.hpp"

namespace thimble {

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
