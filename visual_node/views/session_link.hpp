// A view's connection to the session: receives and stores Monitors, repeats orders until they take effect.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/channel.hpp"
#include "visual_node/views/commands.hpp"
#include "visual_node/views/monitor_history.hpp"
#include "visual_node/views/monitor_receiver.hpp"
#include "visual_node/views/monitor_text.hpp"
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
    SessionLink(std::uint64_t instance, const Channels& channels, double window_s)
        : receiver_(*channels.monitor_in), history_(window_s), orders_(instance, *channels.orders_out) {}

    void update(SessionTime now) {
        receiver_.update(now, [this](SessionTime at, std::uint32_t trial, const Monitor& monitor) {
            history_.add(at, trial, monitor, receiver_.replay() != nullptr);
        });
        orders_.update(now, seen(now));
    }

    void ask(SessionTime now, const Order& order) { orders_.ask(now, order, seen(now)); }
    // About the trial shown.
    void ask(SessionTime now, OrderKind kind, Modality modality = Modality::kHF, double value = 0) {
        Order order;
        order.kind = kind;
        order.trial = receiver_.trial();
        order.modality = modality;
        order.value = value;
        ask(now, order);
    }

    // Delay and network that were last asked while they are not shown yet, then what the session shows.
    double delay_s() const {
        for (const OrderKind kind : {OrderKind::kDelay, OrderKind::kNetwork}) {
            if (orders_.progress(kind) == OrderProgress::kAsking) return orders_.asked(kind).value;
        }
        return monitor().network_delay_s;
    }

    NetworkName network() const {
        const bool asking = orders_.progress(OrderKind::kNetwork) == OrderProgress::kAsking;
        return asking ? orders_.asked(OrderKind::kNetwork).network : monitor().network;
    }

    // taken to the nearest of 0 to kDelayLimit_s
    void ask_delay(SessionTime now, double delay_s) {
        ask(now, OrderKind::kDelay, Modality::kHF, std::clamp(delay_s, 0.0, kDelayLimit_s));
    }

    // Carries out commands that are the same in every view: networks, delay steps, pause, end. False: another
    // command.
    bool take(SessionTime now, Command command) {
        if (const OfferedNetwork* offered = network_of(command)) {
            ask_network(now, *offered);
            return true;
        }
        switch (command) {
            case Command::kDelayDown:
                ask_delay(now, delay_s() - kDelayStep_s);
                return true;
            case Command::kDelayUp:
                ask_delay(now, delay_s() + kDelayStep_s);
                return true;
            case Command::kPause:
                ask(now, monitor().paused ? OrderKind::kResume : OrderKind::kPause);
                return true;
            case Command::kEndTrial:
                ask(now, OrderKind::kEndTrial);
                return true;
            default:
                return false;
        }
    }

    // Whether `command` is the network that holds, with its own delay.
    bool holds(Command command) const {
        const OfferedNetwork* offered = network_of(command);
        return offered != nullptr && network().view() == offered->profile &&
               std::abs(delay_s() - offered->delay_s) < kDelayStep_s / 10;
    }

    const MonitorReceiver& receiver() const { return receiver_; }
    const MonitorHistory& history() const { return history_; }
    const OrderSender& orders() const { return orders_; }
    const Monitor& monitor() const { return receiver_.newest(); }
    bool running(SessionTime now) const {
        return !receiver_.silent(now) && monitor().state == NodeState::kRunning;
    }

    // The warning to read first: no session speaks, or it does not answer. Empty: none.
    TextLine alarm(SessionTime now) const {
        if (!receiver_.heard()) return TextLine::of("Waiting for the session's first message.");
        if (receiver_.silent(now)) {
            return TextLine::of("No message from the session for {}. The values shown are old.",
                                age_text(receiver_.age(now)).view());
        }
        const Order* order = orders_.unanswered();
        if (order != nullptr && order->kind == OrderKind::kNetwork) {
            return TextLine::of("The session has not set the network '{}': its version may not have it.",
                                order->network.view());
        }
        if (order != nullptr) {
            return TextLine::of("The session does not answer: '{}' was requested {} s ago.",
                                to_string(order->kind), to_seconds(kOrderPatience));
        }
        return {};
    }

  private:
    SessionView seen(SessionTime now) const {
        const ReplayState* replay = receiver_.replay();
        return {receiver_.newest(), receiver_.trial(), receiver_.silent(now),
                replay == nullptr ? 1 : replay->speed};
    }

    void ask_network(SessionTime now, const OfferedNetwork& offered) {
        Order order;
        order.kind = OrderKind::kNetwork;
        order.value = offered.delay_s;
        order.network = NetworkName::of(offered.profile).value_or(NetworkName{});
        ask(now, order);
    }

    MonitorReceiver receiver_;
    MonitorHistory history_;
    OrderSender orders_;
};

}  // namespace thimble
