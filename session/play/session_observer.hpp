// Sits beside a session (condition_run.hpp): feeds the views that watch it, the experimenter's and the player's, and takes the orders of
// both.
#pragma once

#include "common/process.hpp"
#include "common/runtime/sockets.hpp"
#include "session/play/monitor_feed.hpp"
#include "session/play/order_taker.hpp"

namespace thimble {

// Each view has ports of its own, so that both can watch one session.
struct ViewChannels {
    Channel* experimenter_monitor;  // out
    Channel* experimenter_orders;   // in
    Channel* player_monitor;
    Channel* player_orders;
};

class SessionObserver final : public Process {
  public:
    // All outlive the observer; `context` is read at each Monitor.
    SessionObserver(std::uint64_t instance, const SessionProcess& session, const ViewChannels& channels,
                    OrderHandler& handler, const MonitorContext& context);

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return feed_.next_wakeup(); }
    bool stopped() const override { return false; }

  private:
    const SessionProcess* session_;
    const MonitorContext* context_;
    MonitorFeed feed_;
    OrderTaker experimenter_, player_;
};

// The session's own end of what views say and hear.
ViewChannels open_view_channels(Sockets& sockets);
std::unique_ptr<Process> make_observer(const SessionProcess& session, Sockets& sockets, OrderHandler& handler,
                                       const MonitorContext& context);

}  // namespace thimble
