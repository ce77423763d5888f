// The duties of every node process besides its own work: obey the session, send heartbeats, and stop safely when the
// session or a peer falls silent. Derived classes add begin_trial / work / end_trial.
#pragma once

#include <algorithm>
#include <string_view>

#include "common/flow.hpp"
#include "common/log/recorder.hpp"
#include "common/ports.hpp"
#include "common/process.hpp"
#include "common/stop_bus.hpp"

namespace thimble {

// Silence after which a running trial is given up (well under the second that users are promised).
inline constexpr Duration kPeerTimeout = std::chrono::milliseconds{500};

// Until an input has crossed the network for the first time, its silence means nothing.
inline Duration first_answer_within(const SessionControl& control) {
    return from_seconds(control.network_delay_s);
}
// NetworkChange: new delay of both ways together, jitter included. An input may be silent for this long.
inline Duration silence_of_change(const SessionControl& control) { return from_seconds(control.silence_s); }

// Reaction to repeated deadline misses. All give a warning. kRest also keeps the outputs at rest until the node is in time again.
// kStop also stops everything.
enum class OverrunPolicy : std::uint8_t { kWarn, kRest, kStop };

// A request to stop everything; kNone: no request.
struct StopRequest {
    EndReason reason = EndReason::kNone;
    std::string_view words{};  // who and why
};

class NodeProcess : public Process {
  public:
    // `control` is the node's end of its channel with the session; `instance` is random per process start.
    NodeProcess(Role role, std::uint64_t instance, Channel& control);

    void tick(SessionTime now) final;
    SessionTime next_wakeup() const final;
    bool stopped() const final { return stopped_; }
    // Earliest time at which silence can end the trial.
    SessionTime patient_until();

    // If the recorder fails, the trial ends as with a failed device. `recorder` outlives this.
    void record_with(const Recorder& recorder) { recorder_ = &recorder; }

    // Connects the stop bus (stop_bus.hpp). Without it a stop of this node reaches the others through the session
    // only.
    void join_stop_bus(Channel& in, const StopOutlets& out) { stop_.connect(in, out); }
    void join_stop_bus(Ports& ports) { stop_.connect(*ports.inlet(stop_port(role_)), stop_outlets(ports)); }
    // A person at this program stops everything, now.
    void stop_everything(SessionTime now, EndReason reason, std::string_view words);
    const StopBus& stop_bus() const { return stop_; }
    // The program ends: its outputs rest now, whatever it does after the last tick.
    void leave(SessionTime now) {
        if (running()) give_up(now, EndReason::kInterrupted);
    }

    // Number of deadlines missed in a row; 0: in time again. Called after each tick. From `limit` on the node counts
    // as late and the policy acts.
    void set_overrun(OverrunPolicy policy, unsigned limit) {
        overrun_ = policy;
        overrun_limit_ = limit;
    }
    void deadlines_missed(SessionTime now, unsigned in_a_row);
    std::uint64_t overruns() const { return overruns_; }  // runs of missed deadlines as long as the limit
    bool late() const { return late_; }

    Role role() const { return role_; }
    NodeState state() const { return state_; }
    EndReason reason() const { return reason_; }
    // Over all inbound flows since start.
    FlowCounters counters() const;

  protected:
    virtual void begin_trial(SessionTime now, const SessionControl& control) = 0;
    // Also when the trial is given up: afterwards no force, nothing in flight.
    virtual void end_trial(SessionTime now) = 0;
    virtual void obey(SessionTime /*now*/, const SessionControl& /*control*/) {}
    // The network has changed: control.network, with control.network_delay_s one way on its force path. Called once
    // per change, also between trials.
    virtual void network_changed(SessionTime /*now*/, const SessionControl& /*control*/) {}
    // The text for the subject between trials. False: this node has no screen, and the message is refused.
    virtual bool read_page(SessionTime /*now*/, const Page& /*page*/) { return false; }
    // Data plane, called on every tick, also between trials (to keep the channels empty).
    virtual void work(SessionTime now) = 0;
    virtual SessionTime next_work() const = 0;
    // The input that this node cannot do without; null: none. Its silence for kPeerTimeout ends the trial. The same
    // throughout a trial.
    virtual InboundFlow* vital_flow() { return nullptr; }
    // Asked after each work(), also between trials: a button of the device, the subject's key or the guard may
    // request a stop.
    virtual StopRequest wants_stop(SessionTime /*now*/) { return {}; }
    // Outputs at rest until the next input, the trial goes on: the node is resting(). Called after work().
    virtual void rest(SessionTime /*now*/) {}
    // Empty while the node's device works; else which device failed, why, and what to do. A fault ends the trial.
    virtual std::string_view device_fault() const { return {}; }
    virtual void add_counters(FlowCounters& /*sum*/) const {}
    virtual void describe(Heartbeat& /*heartbeat*/) const {}

    // Since the previous tick. After a long pause of this program old messages wait in the channels and look new.
    Duration since_last_tick() const { return ticks_.since_last(); }
    bool running() const { return state_ == NodeState::kRunning || state_ == NodeState::kFinished; }
    // True while the node is late under OverrunPolicy::kRest. Then work() must not give any output.
    bool resting() const { return late_ && overrun_ == OverrunPolicy::kRest && running(); }
    std::uint32_t trial() const { return trial_; }
    std::uint64_t instance() const { return instance_; }
    void set_state(NodeState state, EndReason reason = EndReason::kNone);
    // Sends a message to the session besides the heartbeats.
    template <class Body>
    void tell_session(SessionTime now, const Body& body) {
        heartbeats_.send(now, trial_, body);
    }

  private:
    void take_orders(SessionTime now);
    void take_order(SessionTime now, std::uint32_t trial, const SessionControl& control);
    void take_network(SessionTime now, const SessionControl& control);
    void answer(SessionTime now, const ClockProbe& probe);
    void give_up(SessionTime now, EndReason reason);
    void give_up_if_alone(SessionTime now);
    void excuse_standstill();
    void obey_stop(SessionTime now);
    void take_stop_requests(SessionTime now);
    void report(SessionTime now);
    std::string_view fault() const;

    Role role_;
    std::uint64_t instance_;
    Channel* control_;
    const Recorder* recorder_ = nullptr;
    InboundFlow orders_{Role::kSession};
    OutboundFlow heartbeats_;
    StopBus stop_;
    NodeState state_ = NodeState::kIdle;
    EndReason reason_ = EndReason::kNone;
    std::uint32_t trial_ = 0;
    double changed_delay_s_ = -1;  // of the last change; negative: none yet
    NetworkName changed_network_;
    SessionTime next_heartbeat_{};
    SessionTime looks_for_silence_{};  // until then no peer can have been silent for too long
    bool stopped_ = false;
    TickTimes ticks_;
    OverrunPolicy overrun_ = OverrunPolicy::kWarn;
    unsigned overrun_limit_ = 20;
    bool late_ = false;
    std::uint64_t overruns_ = 0;
};

}  // namespace thimble
