#include "common/node_process.hpp"

#include <algorithm>
#include <variant>

namespace thimble {

NodeProcess::NodeProcess(Role role, std::uint64_t instance, Channel& control)
    : role_(role), instance_(instance), control_(&control), heartbeats_(role, instance, {&control}) {}

void NodeProcess::tick(SessionTime now) {
    take_orders(now);
    work(now);
    give_up_if_alone(now);
    report(now);
}

SessionTime NodeProcess::next_wakeup() const { return std::min(next_heartbeat_, next_work()); }

FlowCounters NodeProcess::counters() const {
    FlowCounters sum = orders_.counters();
    add_counters(sum);
    return sum;
}

void NodeProcess::set_state(NodeState state, EndReason reason) {
    state_ = state;
    reason_ = reason;
    next_heartbeat_ = {};  // say so at once
}

void NodeProcess::take_orders(SessionTime now) {
    while (const Message* message = orders_.receive(now, *control_)) {
        const auto* control = std::get_if<SessionControl>(&message->body);
        if (control != nullptr) {
            take_order(now, message->header.trial, *control);
        } else if (const auto* probe = std::get_if<ClockProbe>(&message->body)) {
            answer(now, *probe);
        } else if (const auto* page = std::get_if<Page>(&message->body)) {
            if (!read_page(now, *page)) orders_.refuse_admitted(Refusal::kUnexpectedKind);
        } else if (!std::holds_alternative<Heartbeat>(message->body)) {
            orders_.refuse_admitted(Refusal::kUnexpectedKind);
        }
    }
}

void NodeProcess::answer(SessionTime now, const ClockProbe& probe) {
    heartbeats_.send(now, trial_, ClockReply{probe.send_time, control_->arrival().value_or(now)});
}

// Orders are repeated until their acknowledgement arrives, so each must be harmless the second time.
void NodeProcess::take_order(SessionTime now, std::uint32_t trial, const SessionControl& control) {
    next_heartbeat_ = {};
    switch (control.kind) {
        case ControlKind::kTrialStart:
            if (trial == trial_) return;
            if (running()) end_trial(now);
            trial_ = trial;
            set_state(NodeState::kRunning);
            begin_trial(now, control);
            return;
        case ControlKind::kTrialEnd:
            if (trial != trial_ || state_ == NodeState::kIdle) return;
            if (running()) end_trial(now);
            set_state(NodeState::kIdle, control.reason);
            return;
        case ControlKind::kShutdown:
            if (running()) end_trial(now);
            set_state(NodeState::kIdle, EndReason::kInterrupted);
            stopped_ = true;
            return;
        case ControlKind::kNetworkChange:
            if (trial == trial_) take_network(now, control);
            return;
        case ControlKind::kBeep:
        case ControlKind::kFixtureChange:
            if (trial == trial_ && running()) obey(now, control);
            return;
    }
}

void NodeProcess::take_network(SessionTime now, const SessionControl& control) {
    const bool known = control.network_delay_s == changed_delay_s_ && control.network == changed_network_;
    if (known) return;
    changed_delay_s_ = control.network_delay_s;
    changed_network_ = control.network;
    network_changed(now, control);
}

void NodeProcess::give_up_if_alone(SessionTime now) {
    if (!running()) return;
    if (!fault().empty()) return give_up(now, EndReason::kDeviceFault);
    if (orders_.silent_for(now, kPeerTimeout) || peer_lost(now)) give_up(now, EndReason::kPeerLost);
}

std::string_view NodeProcess::fault() const {
    const std::string_view device = device_fault();
    return device.empty() && recorder_ != nullptr ? recorder_->fault() : device;
}

void NodeProcess::give_up(SessionTime now, EndReason reason) {
    end_trial(now);
    set_state(NodeState::kFailed, reason);
}

void NodeProcess::report(SessionTime now) {
    if (now < next_heartbeat_) return;
    next_heartbeat_ = now + kHeartbeatPeriod;
    const FlowCounters sum = counters();
    Heartbeat heartbeat;
    heartbeat.accepted = sum.accepted;
    heartbeat.refused = sum.refused_total();
    heartbeat.state = state_;
    heartbeat.reason = reason_;
    describe(heartbeat);
    heartbeats_.send(now, trial_, heartbeat);
    if (reason_ == EndReason::kDeviceFault && state_ == NodeState::kFailed) {
        heartbeats_.send(now, trial_, DeviceFault(fault()));
    }
}

}  // namespace thimble
