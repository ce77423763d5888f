// A view's two ends of its talk with the session: Monitors in, kept and remembered; Orders out, until they show.
#pragma once

#include "common/channel.hpp"
#include "visual_node/views/commands.hpp"
#include "visual_node/views/monitor_history.hpp"
#include "visual_node/views/monitor_receiver.hpp"
#include "visual_node/views/order_sender.hpp"
#include "visual_node/views/text_line.hpp"

namespace thimble {

class SessionLink {
  public:
    // The channels outlive the link.
    struct Channels {
        Channel* monitor_in;
        Channel* orders_out;
    };
    SessionLink(std::uint64_t instance, const Channels& channels, double window_s);

    void update(SessionTime now);
    void ask(SessionTime now, const Order& order);
    // About the trial shown.
    void ask(SessionTime now, OrderKind kind, Modality modality = Modality::kHF, double value = 0);
    // Delay and network that were last asked while they are not shown yet, then what the session shows.
    double delay_s() const;
    NetworkName network() const;
    void ask_delay(SessionTime now, double delay_s);  // taken to the nearest of 0 to kDelayLimit_s
    // What means the same in every view of a session: networks, steps of the delay, pause, end. False: another command.
    bool take(SessionTime now, Command command);
    // Whether `command` is the network that holds, with its own delay.
    bool holds(Command command) const;

    const MonitorReceiver& receiver() const { return receiver_; }
    const MonitorHistory& history() const { return history_; }
    const OrderSender& orders() const { return orders_; }
    const Monitor& monitor() const { return receiver_.newest(); }
    bool running(SessionTime now) const;

    // The warning to read first: no session speaks, or it does not answer. Empty: none.
    TextLine alarm(SessionTime now) const;

  private:
    SessionView seen(SessionTime now) const;
    void ask_network(SessionTime now, const OfferedNetwork& offered);

    MonitorReceiver receiver_;
    MonitorHistory history_;
    OrderSender orders_;
};

}  // namespace thimble
