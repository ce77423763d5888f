// Feeds the views of a session (condition_run.hpp), the experimenter's and the player's, and takes the orders of
// both.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include <boost/core/noncopyable.hpp>

#include "common/flow.hpp"
#include "common/process.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/play/monitor_feed.hpp"
#include "session/run/condition_plan.hpp"

namespace thimble {

class OrderHandler : boost::noncopyable {
  public:
    virtual ~OrderHandler() = default;

    // Carries out an order, or returns why not. A repeated order has the same result.
    virtual std::optional<Refusal> obey(SessionTime now, const Order& order) = 0;
};

// Carries out the orders of a view, each of them once. A view repeats an order until the Monitor shows it. The header names the
// trial for which the view asked. So a late Start or EndTrial does not count for the next trial.
class OrderTaker {
  public:
    // A Repeat or an Exclude that comes again within this time is the same one, said again because UDP loses.
    static constexpr Duration kSameRequest = std::chrono::seconds{1};

    // Both outlive the taker.
    OrderTaker(Channel& in, OrderHandler& handler) : in_(&in), handler_(&handler) {}

    // `trial`: the newest, on the wire.
    void tick(SessionTime now, std::uint32_t trial) {
        while (const Message* message = flow_.receive(now, *in_)) {
            const auto* order = std::get_if<Order>(&message->body);
            const std::optional<Refusal> refusal = order == nullptr
                                                       ? std::optional{Refusal::kUnexpectedKind}
                                                       : judge(now, message->header.trial, trial, *order);
            if (refusal) flow_.refuse_admitted(*refusal);
        }
    }

    const FlowCounters& counters() const { return flow_.counters(); }

  private:
    struct Request {
        std::uint32_t trial = 0;
        SessionTime last{};
        bool said = false;
    };
    std::optional<Refusal> judge(SessionTime now, std::uint32_t asked_for, std::uint32_t trial,
                                 const Order& order) {
        switch (order.kind) {
            case OrderKind::kStart:
            case OrderKind::kEndTrial:
                if (asked_for != trial) return Refusal::kWrongTrial;
                break;
            case OrderKind::kRepeat:
            case OrderKind::kExclude:
                // Only the newest trial can be rejected or excluded, as on the terminal.
                if (order.trial != trial) return Refusal::kWrongTrial;
                if (said_again(now, order.kind == OrderKind::kRepeat ? repeat_ : exclude_, trial))
                    return std::nullopt;
                break;
            default:
                break;
        }
        return handler_->obey(now, order);
    }

    bool said_again(SessionTime now, Request& request, std::uint32_t trial) {
        const bool again = request.said && request.trial == trial && now - request.last <= kSameRequest;
        request = {trial, now, true};
        return again;
    }

    Channel* in_;
    OrderHandler* handler_;
    InboundFlow flow_{Role::kExperimenter};
    Request repeat_, exclude_;
};

// Each view has ports of its own, so that both can watch one session.
struct ViewChannels {
    Channel* experimenter_monitor;  // out
    Channel* experimenter_orders;   // in
    Channel* player_monitor;
    Channel* player_orders;
};

class SessionObserver final : public Observer {
  public:
    // All outlive the observer; `context` is read at each Monitor.
    SessionObserver(std::uint64_t instance, const SessionProcess& session, const ViewChannels& channels,
                    OrderHandler& handler, const MonitorContext& context)
        : session_(&session),
          context_(&context),
          feed_(instance, {channels.experimenter_monitor, channels.player_monitor}, session),
          experimenter_(*channels.experimenter_orders, handler),
          player_(*channels.player_orders, handler) {}

    void tick(SessionTime now) override {
        experimenter_.tick(now, session_->number());
        player_.tick(now, session_->number());
        feed_.tick(now, *context_);
    }

    void serve(const SessionProcess& session, Duration ahead) override {
        session_ = &session;
        feed_.serve(session, ahead);
    }

    SessionTime next_wakeup() const override { return feed_.next_wakeup(); }
    bool stopped() const override { return false; }

  private:
    const SessionProcess* session_;
    const MonitorContext* context_;
    MonitorFeed feed_;
    OrderTaker experimenter_, player_;
};

// The session's own end of what views say and hear.
inline ViewChannels open_view_channels(Sockets& sockets) {
    Channel* const experimenter = sockets.between(Port::kSessionOrders, Port::kExperimenterMonitor);
    Channel* const player = sockets.between(Port::kSessionPlayerOrders, Port::kPlayerMonitor);
    return {experimenter, experimenter, player, player};
}

inline std::unique_ptr<Observer> make_observer(const SessionProcess& session, Sockets& sockets,
                                               OrderHandler& handler, const MonitorContext& context) {
    return std::make_unique<SessionObserver>(system_entropy(), session, open_view_channels(sockets), handler,
                                             context);
}

}  // namespace thimble
