#include "tests/views/fake_session.hpp"

#include <algorithm>

#include "tests/views/demonstration.hpp"

namespace thimble {
namespace {

constexpr Duration kMonitorPeriod = std::chrono::milliseconds{4};

NetworkSettings view_network(std::uint16_t base_port) {
    NetworkSettings network;
    network.base_port = base_port;
    return network;
}

}  // namespace

FakeSession::FakeSession(std::uint16_t base_port, std::uint64_t instance, SessionTime started)
    : sockets_(view_network(base_port)),
      monitors_(Role::kSession, instance,
                {sockets_.outlet(Port::kExperimenterMonitor), sockets_.outlet(Port::kPlayerMonitor)}),
      orders_in_{sockets_.inlet(Port::kSessionOrders), sockets_.inlet(Port::kSessionPlayerOrders)},
      started_(started) {}

int FakeSession::count(OrderKind kind) const {
    return static_cast<int>(std::count_if(heard_.begin(), heard_.end(),
                                          [kind](const Order& order) { return order.kind == kind; }));
}

void FakeSession::take(const Order& order, SessionTime now) {
    heard_.push_back(order);
    if (!obeys_) return;
    if (order.kind == OrderKind::kDelay) delay_s_ = order.value;
    if (order.kind == OrderKind::kNetwork) {
        network_ = order.network;
        delay_s_ = order.value;
    }
    if (order.kind == OrderKind::kPause) paused_ = true;
    if (order.kind == OrderKind::kResume) paused_ = false;
    if (order.kind == OrderKind::kEndTrial) running_ = false;
    if (order.kind == OrderKind::kStart && order.trial == trial_) {
        ++trial_;
        started_ = now;
        running_ = true;
        modality_ = order.modality;
    }
}

void FakeSession::speak(SessionTime now) {
    Monitor monitor = demonstration(time_s(now));
    monitor.network_delay_s = delay_s_;
    monitor.network = network_;
    monitor.paused = paused_;
    monitor.modality = modality_;
    if (!running_ || fault_) monitor.state = NodeState::kIdle;
    if (fault_) {
        monitor.reason = EndReason::kDeviceFault;
        monitors_.send(now, trial_, *fault_);
    }
    monitors_.send(now, trial_, monitor);
}

void FakeSession::tick(SessionTime now) {
    for (std::size_t i = 0; i < orders_in_.size(); ++i) {
        while (const Message* message = inbound_[i].receive(now, *orders_in_[i])) {
            if (const auto* order = std::get_if<Order>(&message->body)) take(*order, now);
        }
    }
    if (next_ == SessionTime{}) next_ = now;
    // After a stall the samples of the stall come all at once, as recorded.
    for (; next_ <= now; next_ += kMonitorPeriod) speak(next_);
}

}  // namespace thimble
