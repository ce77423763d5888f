// slave_sim: answers each needle command the moment it arrives (waiting for a tick of its own would cost the
// loop up to a millisecond), watches the contact time, gives the beep.
#pragma once

#include "common/node_process.hpp"
#include "common/stale_record.hpp"
#include "slave_sim/slave_node.hpp"

namespace thimble {

class SlaveProcess final : public NodeProcess {
  public:
    struct Channels {
        Channel* control;
        Channel* needle_in;     // from the master, through netem
        Channel* force_master;  // these three through netem
        Channel* force_cutaneous;
        Channel* force_visual;
        Channel* beep_visual;  // the experiment's beep is not part of the delayed path
        Channel* record;       // every answer, undelayed, to the session's recorder
    };

    SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, const Channels& channels);
    // Opens its channels.
    SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, Ports& ports);

    const StaleRecord& stale_record() const { return stale_record_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime now) override;
    void obey(SessionTime now, const SessionControl& control) override;
    void network_changed(SessionTime now, const SessionControl& control) override {
        needle_flow_.excuse_silence_until(now + silence_of_change(control));
    }
    void work(SessionTime now) override;
    SessionTime next_work() const override { return running() ? std::min(next_hold_, next_beep_) : kNever; }
    bool peer_lost(SessionTime now) const override { return needle_flow_.lost_for(now, kPeerTimeout); }
    void rest(SessionTime now) override { force_flow_.send(now, trial(), node_.hold()); }
    void add_counters(FlowCounters& sum) const override { sum.add(needle_flow_.counters()); }

  private:
    void answer(SessionTime now, const ForceFeedback& feedback);
    void send(SessionTime now, const ForceFeedback& feedback);
    void send_beep(SessionTime now);

    Channels channels_;
    SlaveSettings settings_;
    SlaveNode node_;
    StaleRecord stale_record_;
    InboundFlow needle_flow_{Role::kMaster};
    OutboundFlow force_flow_;
    OutboundFlow wave_flow_, force_flow_beside_waves_;  // with waves: to the master, to the others
    OutboundFlow beep_flow_;
    SessionTime next_hold_ = kNever;
    SessionTime next_beep_ = kNever;
    int beeps_left_ = 0;
};

}  // namespace thimble
