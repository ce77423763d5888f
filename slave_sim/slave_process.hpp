// slave_sim: answers each needle command when it arrives (a tick of its own would cost the loop up to a millisecond),
// measures the contact time and triggers the beep. With [codec] command it also answers the samples that the master
// did not send.
#pragma once

#include "common/node_process.hpp"
#include "common/reduction/force_codec.hpp"
#include "common/reduction/needle_codec.hpp"
#include "common/stale_record.hpp"
#include "slave_sim/slave_node.hpp"

namespace thimble {

class RemoteNeedle;

class SlaveProcess final : public NodeProcess {
  public:
    // Opens its channels.
    // `robot` moves the needle and outlives this; null: the needle is simulated.
    SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, Ports& ports,
                 RemoteNeedle* robot = nullptr);

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
    SessionTime next_work() const override;
    std::string_view device_fault() const override;
    InboundFlow* vital_flow() override { return &needle_flow_; }
    void rest(SessionTime now) override { hold(now); }
    void add_counters(FlowCounters& sum) const override { sum.add(needle_flow_.counters()); }

  private:
    void hear(SessionTime now, const Header& header, const NeedleWave& message);
    void answer(SessionTime now, SessionTime stamp, std::uint32_t sequence, const NeedleWave& message);
    ForceFeedback moved(SessionTime now, SessionTime stamp, std::uint32_t sequence,
                        const NeedleWave& message);
    void hold(SessionTime now);
    void send(SessionTime now, const ForceFeedback& feedback);
    void send_beep(SessionTime now);

    RemoteNeedle* robot_;
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
    NeedleWave heard_;  // a command that came without waves
    SessionTime next_hold_ = kNever;
    SessionTime next_beep_ = kNever;
    int beeps_left_ = 0;
};

}  // namespace thimble
