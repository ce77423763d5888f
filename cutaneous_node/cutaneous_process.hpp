// cutaneous_node: force feedback in (through netem), finger pressed, percept out to the wearer.
#pragma once

#include <algorithm>

#include "common/node_process.hpp"
#include "common/stale_record.hpp"
#include "cutaneous_node/cutaneous_node.hpp"
#include "cutaneous_node/guarded_actuator.hpp"

namespace thimble {

class CutaneousProcess final : public NodeProcess {
  public:
    // Opens its channels. `actuator` outlives the process.
    CutaneousProcess(std::uint64_t instance, const CutaneousSettings& settings, Ports& ports,
                     FingertipActuator& actuator)
        : NodeProcess(Role::kCutaneous, instance,
                      *ports.between(Port::kCutaneousControl, Port::kSessionCutaneous)),
          force_in_(ports.inlet(Port::kCutaneousForce)),
          percept_flow_(Role::kCutaneous, instance, {ports.outlet(Port::kMasterPerceptCutaneous)}),
          actuator_(settings.guard_limit_N, actuator),
          node_(settings, actuator_) {
        join_stop_bus(ports);
    }

    const StaleRecord& stale_record() const { return stale_record_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override {
        force_flow_.expect_from(now + first_answer_within(control) + kPeerTimeout);  // the master starts last
        actuator_.clear(now);
        node_.start_trial(now, control, force_flow_.last_accepted());
    }

    void end_trial(SessionTime now) override {
        stale_record_.end(now);
        node_.end_trial(now);
    }
    void network_changed(SessionTime now, const SessionControl& control) override {
        force_flow_.excuse_silence_until(now + silence_of_change(control));
        node_.network_changed(silence_of_change(control));
    }
    void work(SessionTime now) override {
        node_.begin_tick(now, since_last_tick(), resting());
        force_flow_.drain<ForceFeedback>(now, *force_in_, running(), trial(),
                                         [&](const Header& header, const ForceFeedback& feedback) {
                                             node_.on_feedback(now, header.send_time, feedback);
                                         });
        if (running() && node_.presses()) stale_record_.watch(now, trial(), node_.stale(now));
        actuator_.tick(now);
        if (const auto percept = node_.percept(now)) percept_flow_.send(now, trial(), *percept);
    }

    SessionTime next_work() const override { return std::min(node_.next_percept(), actuator_.next_wakeup()); }
    // A fault ends only trials whose fingers are pressed; the others do not need the device.
    std::string_view device_fault() const override {
        return node_.presses() ? actuator_.fault() : std::string_view{};
    }
    StopRequest wants_stop(SessionTime /*now*/) override {
        if (!running() || !actuator_.tripped()) return {};
        return {EndReason::kSafetyStop, actuator_.text()};
    }
    InboundFlow* vital_flow() override { return &force_flow_; }
    void add_counters(FlowCounters& sum) const override { sum.add(force_flow_.counters()); }

  private:
    Channel* force_in_;          // from slave_sim, through netem
    OutboundFlow percept_flow_;  // to the virtual operator: skin, not network
    GuardedActuator actuator_;
    CutaneousNode node_;
    StaleRecord stale_record_;
    InboundFlow force_flow_{Role::kSlaveSim};
};

}  // namespace thimble
