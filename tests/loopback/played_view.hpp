// An experimenter's view, or a player's panel, as a session sees it: hears the Monitor (and ReplayState), sends orders.
#pragma once

#include <set>
#include <variant>

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

class PlayedView {
  public:
    enum class Ports { kExperimenter, kPlayer };
    explicit PlayedView(std::uint16_t base_port, Ports ports = Ports::kExperimenter,
                        const SecuritySettings& security = {})
        : sockets_(network_at(base_port, security)),
          link_(ports == Ports::kPlayer ? sockets_.between(Port::kPlayerMonitor, Port::kSessionPlayerOrders)
                                        : sockets_.between(Port::kExperimenterMonitor, Port::kSessionOrders)),
          orders_(Role::kExperimenter, ports == Ports::kPlayer ? 201 : 200, {link_}) {}

    void listen(SessionTime now) {
        sockets_.tick(now);
        while (const Message* message = heard_.receive(now, *link_)) {
            if (const auto* replay = std::get_if<ReplayState>(&message->body)) replay_ = *replay;
            const auto* monitor = std::get_if<Monitor>(&message->body);
            if (monitor == nullptr) continue;
            monitor_ = *monitor;
            trial_ = message->header.trial;
            if (running()) trials_.insert(trial_);
        }
    }
    // For the trial that the Monitor showed last, as a view does it.
    void order(SessionTime now, const Order& order) { orders_.send(now, trial_, order); }
    void order(SessionTime now, OrderKind kind, double value = 0) {
        this->order(now, Order{.value = value, .kind = kind});
    }

    const Monitor& monitor() const { return monitor_; }
    const ReplayState& replay() const { return replay_; }  // of length 0 before the first
    std::uint32_t trial() const { return trial_; }
    const std::set<std::uint32_t>& trials() const { return trials_; }  // that it has seen run
    std::uint64_t heard() const { return heard_.counters().accepted; }
    bool running() const { return monitor_.state == NodeState::kRunning; }

  private:
    Sockets sockets_;
    Channel* link_;
    InboundFlow heard_{Role::kSession};
    OutboundFlow orders_;
    Monitor monitor_;
    ReplayState replay_;
    std::uint32_t trial_ = 0;
    std::set<std::uint32_t> trials_;
};

}  // namespace thimble
