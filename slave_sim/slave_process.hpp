// slave_sim: answers each needle command the moment it arrives (waiting for a tick of its own would cost the
// loop up to a millisecond), watches the contact time, gives the beep. With [codec] command it also answers the samples that the
// master did not send.
#pragma once

#include "common/node_process.hpp"
#include "common/reduction/force_codec.hpp"
#include "common/reduction/needle_codec.hpp"
#include "common/stale_record.hpp"
#include "slave_sim/slave_node.hpp"

namespace thimble {

class SlaveProcess final : public NodeProcess {
  public:
    // Opens its channels.
    SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, Ports& ports);

    const StaleRecord& stale_record() const { return stale_record_; }
    const SlaveEnd* plugin() const { return node_.plugin(); }  // null: the session has none with an end here

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime now) override;
    void obey(SessionTime now, const SessionControl& control) override;
    void network_changed(SessionTime now, const SessionControl& control) override {
        needle_flow_.excuse_silence_until(now + silence_of_change(control));
    }
    void work(SessionTime now) override;
    SessionTime next_work() const override {
        return running() ? std::min({next_hold_, next_beep_, fill_.next()}) : kNever;
    }
    InboundFlow* vital_flow() override { return &needle_flow_; }
    void rest(SessionTime now) override { send(now, node_.hold()); }
    void add_counters(FlowCounters& sum) const override { sum.add(needle_flow_.counters()); }

  private:
    void hear(SessionTime now, const Header& header, const NeedleWave& message);
    void answer(SessionTime now, SessionTime stamp, std::uint32_t sequence, const NeedleWave& message);
    void send(SessionTime now, const ForceFeedback& feedback);
    void send_beep(SessionTime now);

    Channel* needle_in_;  // from the master, through netem
    // Answers, through netem. The master's copy leaves first: the loop waits for that one.
    OutboundFlow to_master_, to_others_;
    OutboundFlow to_record_;  // every answer, to the session's recorder
    OutboundFlow to_eyes_;    // picture and beep, which no network delays
    NeedleFill fill_;
    ForceGate gate_master_, gate_others_;
    Duration stale_after_;
    SlaveNode node_;
    StaleRecord stale_record_;
    InboundFlow needle_flow_{Role::kMaster};
    SessionTime next_hold_ = kNever;
    SessionTime next_beep_ = kNever;
    int beeps_left_ = 0;
};

}  // namespace thimble
