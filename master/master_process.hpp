// master: reads the handle at 1 kHz, sends the needle, gives the returned force to the handle as it arrives,
// and passes on what skin and eyes get to whoever holds the handle.
#pragma once

#include <algorithm>

#include "common/force_age.hpp"
#include "common/node_process.hpp"
#include "common/round_trip.hpp"
#include "common/stale_record.hpp"
#include "master/devices/hand_follower.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/force_guard.hpp"
#include "master/master_node.hpp"
#include "master/operator/operator_port.hpp"
#include "master/port_energy.hpp"

namespace thimble {

class MasterProcess final : public NodeProcess {
  public:
    struct Channels {
        Channel* control;
        Channel* needle_out;         // to slave_sim, through netem
        Channel* force_in;           // from slave_sim, through netem
        Channel* percept_cutaneous;  // from cutaneous_node, never delayed
        Channel* percept_visual;     // from visual_node, never delayed
    };

    // `person` holds `device`; both outlive the process.
    MasterProcess(std::uint64_t instance, const MasterSettings& settings, const Channels& channels,
                  HapticDevice& device, OperatorPort& person);
    // Opens its channels. `follower`, where there is one, learns what a person's pointer draws.
    MasterProcess(std::uint64_t instance, const MasterSettings& settings, Ports& ports, HapticDevice& device,
                  OperatorPort& person, HandFollower* follower = nullptr);

    // From now on `follower` learns what comes in at `hand_in` (a person's pointer, never delayed). Both outlive the
    // process.
    void follow_hand(Channel& hand_in, HandFollower& follower);

    const ForceGuard& guard() const { return guard_; }
    const PortEnergy& energy() const { return energy_; }  // of this trial
    const StaleRecord& stale_record() const { return stale_record_; }
    const RoundTrip& round_trip() const { return round_trip_; }
    std::uint64_t samples() const { return samples_; }
    std::uint64_t samples_skipped() const { return samples_skipped_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime now) override;
    void network_changed(SessionTime now, const SessionControl& control) override {
        force_flow_.excuse_silence_until(now + silence_of_change(control));
        age_.allow(longest_age(silence_of_change(control)));
        node_.control().network_changed(silence_of_change(control));
    }
    void work(SessionTime now) override;
    SessionTime next_work() const override {
        return std::min(running() ? next_sample_ : kNever, device_->next_look());
    }
    bool peer_lost(SessionTime now) const override { return force_flow_.lost_for(now, kPeerTimeout); }
    std::string_view device_fault() const override { return device_->fault(); }
    StopRequest wants_stop(SessionTime now) override;
    void rest(SessionTime now) override { apply(now, 0); }
    void add_counters(FlowCounters& sum) const override;
    void describe(Heartbeat& heartbeat) const override;

  private:
    void take_hand(SessionTime now);
    void take_percepts(SessionTime now);
    void take_forces(SessionTime now);
    void take_force(SessionTime now, const ForceFeedback& feedback);
    void sample(SessionTime now);
    void send_needle(SessionTime now, const NeedleCommand& command);
    void apply(SessionTime now, double force_hand_N);
    // So old may a force become under a network that takes so long there and back.
    Duration longest_age(Duration network_delay) const;
    // Messages that waited while this program stood still say nothing about now.
    bool stood_still() const { return since_last_tick() > node_.settings().stale.after; }
    // Without news: silent, or with forces that are too late.
    Duration silence(SessionTime now) const;
    double share(SessionTime now) const;
    void fade(SessionTime now);

    Channels channels_;
    MasterNode node_;
    ForceGuard guard_;
    StaleRecord stale_record_;
    ForceAge age_;              // of the newest force
    double asked_force_N_ = 0;  // by the newest feedback
    HapticDevice* device_;
    OperatorPort* person_;
    OutboundFlow needle_flow_;
    InboundFlow force_flow_{Role::kSlaveSim};
    InboundFlow cutaneous_flow_{Role::kCutaneous};
    InboundFlow visual_flow_{Role::kVisual};
    Channel* hand_in_ = nullptr;
    HandFollower* follower_ = nullptr;
    InboundFlow hand_flow_{Role::kVisual};
    RoundTrip round_trip_;
    Duration newest_age_{};  // of a force at the handle
    PortEnergy energy_;
    Percept percept_;  // newest of skin and eyes
    SessionTime next_sample_{};
    SessionTime sampled_{};  // the newest sample
    std::uint64_t samples_ = 0, samples_skipped_ = 0;
};

}  // namespace thimble
