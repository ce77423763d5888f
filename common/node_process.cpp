#include "common/node_process.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <variant>

namespace thimble {

NodeProcess::NodeProcess(Role role, std::uint64_t instance, Channel& control)
    : role_(role),
      instance_(instance),
      control_(&control),
      heartbeats_(role, instance, {&control}),
      stop_(role, instance) {}

// A stop comes before everything else, so that no order and no input of the same tick is obeyed after it.
void NodeProcess::tick(SessionTime now) {
    ticks_.tick(now);
    excuse_standstill();
    stop_.tick(now);
    obey_stop(now);
    take_orders(now);
    work(now);
    take_stop_requests(now);
    if (resting()) rest(now);
    give_up_if_alone(now);
    if (now >= next_heartbeat_) report(now);
}

SessionTime NodeProcess::next_wakeup() const {
    const SessionTime work = next_work(), other = std::min(next_heartbeat_, stop_.next());
    return work < other ? work : other;
}

// Each of a tick's parts is called here only: the compiler makes one function of them.
inline void NodeProcess::obey_stop(SessionTime now) {
    if (stop_.stopped() && running()) give_up(now, stop_.reason());
}

inline void NodeProcess::take_stop_requests(SessionTime now) {
    const StopRequest request = wants_stop(now);
    if (is_stop(request.reason)) stop_everything(now, request.reason, request.words);
}

void NodeProcess::stop_everything(SessionTime now, EndReason reason, std::string_view words) {
    stop_.stop(now, reason, words);
    obey_stop(now);
}

void NodeProcess::deadlines_missed(SessionTime now, unsigned in_a_row) {
    const bool late = in_a_row >= overrun_limit_;
    if (late && !late_) {
        ++overruns_;
        if (overrun_ == OverrunPolicy::kStop && running()) {
            std::array<char, 96> words{};
            std::snprintf(words.data(), words.size(), "%s missed %u deadlines in a row", to_string(role_),
                          in_a_row);
            stop_everything(now, EndReason::kSafetyStop, words.data());
        }
    }
    late_ = late;
}

FlowCounters NodeProcess::counters() const {
    FlowCounters sum = orders_.counters();
    sum.add(stop_.counters());
    add_counters(sum);
    return sum;
}

void NodeProcess::set_state(NodeState state, EndReason reason) {
    state_ = state;
    reason_ = reason;
    next_heartbeat_ = {};  // report the change at once
}

inline void NodeProcess::take_orders(SessionTime now) {
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
            if (stop_.stopped()) return set_state(NodeState::kFailed, stop_.reason());
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

inline void NodeProcess::give_up_if_alone(SessionTime now) {
    if (!running()) return;
    if (!fault().empty()) return give_up(now, EndReason::kDeviceFault);
    if (now <= looks_for_silence_) return;  // nearly always: a peer that speaks has more time
    looks_for_silence_ = patient_until();
    const InboundFlow* vital = vital_flow();
    const bool peer_lost = vital != nullptr && vital->lost_for(now, kPeerTimeout);
    if (orders_.silent_for(now, kPeerTimeout) || peer_lost) give_up(now, EndReason::kPeerLost);
}

SessionTime NodeProcess::patient_until() {
    if (!running()) return kNever;
    const InboundFlow* const vital = vital_flow();
    const SessionTime heard = vital == nullptr ? orders_.last_accepted()
                                               : std::min(orders_.last_accepted(), vital->last_accepted());
    return heard + kPeerTimeout;
}

inline void NodeProcess::excuse_standstill() {
    if (ticks_.stood_still() == Duration{}) return;  // the usual case
    orders_.did_not_listen(ticks_.stood_still());
    if (InboundFlow* vital = vital_flow()) vital->did_not_listen(ticks_.stood_still());
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
    next_heartbeat_ = now + kHeartbeatPeriod;
    const FlowCounters sum = counters();
    Heartbeat heartbeat;
    heartbeat.accepted = sum.accepted;
    heartbeat.refused = sum.refused_total();
    heartbeat.state = state_;
    heartbeat.reason = reason_;
    describe(heartbeat);
    heartbeats_.send(now, trial_, heartbeat);
    if (state_ != NodeState::kFailed) return;
    if (reason_ == EndReason::kDeviceFault) heartbeats_.send(now, trial_, DeviceFault(fault()));
    if (is_stop(reason_)) heartbeats_.send(now, trial_, DeviceFault(stop_.words()));
}

}  // namespace thimble
