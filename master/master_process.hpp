// The master reads the handle at 1 kHz, sends the needle, and gives the returned force to the handle as it arrives. It passes the
// percepts of skin and eyes on to the operator.
#pragma once

#include <algorithm>

#include "common/node_process.hpp"
#include "common/reduction/needle_codec.hpp"
#include "common/stale_record.hpp"
#include "master/guarded_handle.hpp"
#include "master/master_node.hpp"
#include "master/operator/operator_port.hpp"

namespace thimble {

class MasterProcess final : public NodeProcess {
  public:
    // Opens its channels. `person` holds `device`; both outlive the process. `follower`, where there is one, outlives it too and
    // learns what a person's pointer draws.
    MasterProcess(std::uint64_t instance, const MasterSettings& settings, Ports& ports, HapticDevice& device,
                  OperatorPort& person, HandFollower* follower = nullptr);

    const GuardedHandle& guard() const { return handle_; }
    const PortObserver& energy() const { return handle_.energy(); }  // of this trial
    const StaleRecord& stale_record() const { return stale_record_; }
    const RoundTrip& round_trip() const { return node_.round_trip(); }
    std::uint64_t samples() const { return node_.samples(); }
    std::uint64_t samples_skipped() const { return node_.samples_skipped(); }
    const HandleEnd* plugin() const { return node_.plugin(); }  // null: the session has none

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime now) override;
    void network_changed(SessionTime now, const SessionControl& control) override {
        force_flow_.excuse_silence_until(now + silence_of_change(control));
        node_.network_changed(silence_of_change(control));
    }
    void work(SessionTime now) override;
    SessionTime next_work() const override { return std::min(node_.next_sample(), handle_.next_look()); }
    InboundFlow* vital_flow() override { return &force_flow_; }
    std::string_view device_fault() const override { return handle_.fault(); }
    StopRequest wants_stop(SessionTime now) override;
    void rest(SessionTime now) override { apply(now, 0); }
    void add_counters(FlowCounters& sum) const override;
    void describe(Heartbeat& heartbeat) const override;

  private:
    void take_hand(SessionTime now);
    void take_percepts(SessionTime now);
    void take_forces(SessionTime now);
    template <class Body>
    void take_forces_as(SessionTime now);
    void sample(SessionTime now);
    void send_needle(SessionTime now, const NeedleCommand& command);
    void apply(SessionTime now, std::optional<double> force_hand_N);

    OutboundFlow needle_flow_;  // to slave_sim, through netem
    NeedleGate needle_gate_;
    // From slave_sim through netem; from cutaneous_node, visual_node and a person's pointer without delay.
    Channel *force_in_, *cutaneous_in_, *visual_in_, *hand_in_ = nullptr;
    MasterNode node_;
    GuardedHandle handle_;
    OperatorPort* person_;
    StaleRecord stale_record_;
    InboundFlow force_flow_{Role::kSlaveSim};
    InboundFlow cutaneous_flow_{Role::kCutaneous};
    InboundFlow visual_flow_{Role::kVisual};
    HandFollower* follower_ = nullptr;
    InboundFlow hand_flow_{Role::kVisual};
};

}  // namespace thimble
