#include "experiment/play/attendant.hpp"

#include "common/runtime/wall_clock.hpp"

namespace thimble {

Attendant::Attendant(std::uint64_t instance, const SessionProcess& session, Channel& monitor_out,
                     Channel& orders_in, OrderHandler& handler, const MonitorContext& context)
    : session_(&session),
      context_(&context),
      feed_(instance, monitor_out, session),
      orders_(orders_in, handler) {}

void Attendant::tick(SessionTime now) {
    orders_.tick(now, session_->number());
    feed_.tick(now, *context_);
}

std::unique_ptr<Process> attend(const SessionProcess& session, Sockets& sockets, OrderHandler& handler,
                                const MonitorContext& context) {
    Channel* orders = sockets.inlet(Port::kSessionOrders, Role::kExperimenter);
    return std::make_unique<Attendant>(system_entropy(), session, *sockets.outlet(Port::kExperimenterMonitor),
                                       *orders, handler, context);
}

}  // namespace thimble
