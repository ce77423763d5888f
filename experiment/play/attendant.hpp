// Sits beside a session (lane.hpp): feeds the view that watches it and takes its orders.
#pragma once

#include "common/process.hpp"
#include "common/runtime/sockets.hpp"
#include "experiment/play/monitor_feed.hpp"
#include "experiment/play/order_taker.hpp"

namespace thimble {

class Attendant final : public Process {
  public:
    // All outlive the attendant; `context` is read at each Monitor.
    Attendant(std::uint64_t instance, const SessionProcess& session, Channel& monitor_out, Channel& orders_in,
              OrderHandler& handler, const MonitorContext& context);

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return feed_.next_wakeup(); }
    bool stopped() const override { return false; }

    const FlowCounters& orders() const { return orders_.counters(); }

  private:
    const SessionProcess* session_;
    const MonitorContext* context_;
    MonitorFeed feed_;
    OrderTaker orders_;
};

// With the sockets of the session's own end: ports kSessionOrders and kExperimenterMonitor.
std::unique_ptr<Process> attend(const SessionProcess& session, Sockets& sockets, OrderHandler& handler,
                                const MonitorContext& context);

}  // namespace thimble
