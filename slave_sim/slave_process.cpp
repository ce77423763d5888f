#include "slave_sim/slave_process.hpp"

namespace thimble {
namespace {

// UDP may lose a datagram, and a beep is not acknowledged. So it is sent again, and a second one is harmless.
constexpr int kBeeps = 5;
constexpr Duration kBeepInterval = std::chrono::milliseconds{20};

}  // namespace

SlaveProcess::SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, const Channels& channels)
    : NodeProcess(Role::kSlaveSim, instance, *channels.control),
      channels_(channels),
      settings_(settings),
      node_(settings),
      // The master's copy leaves first: the loop waits for that one.
      force_flow_(Role::kSlaveSim, instance,
                  {channels.force_master, channels.force_cutaneous, channels.force_visual, channels.record}),
      wave_flow_(Role::kSlaveSim, instance, {channels.force_master}),
      force_flow_beside_waves_(Role::kSlaveSim, instance,
                               {channels.force_cutaneous, channels.force_visual, channels.record}),
      beep_flow_(Role::kSlaveSim, instance, {channels.beep_visual}) {}

SlaveProcess::SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, Ports& ports)
    : SlaveProcess(instance, settings,
                   {ports.between(Port::kSlaveControl, Port::kSessionSlave), ports.inlet(Port::kSlaveNeedle),
                    ports.outlet(Port::kNetemForceMaster), ports.outlet(Port::kNetemForceCutaneous),
                    ports.outlet(Port::kNetemForceVisual), ports.outlet(Port::kVisualBeep),
                    ports.outlet(Port::kSessionRecord)}) {
    join_stop_bus(ports);
}

void SlaveProcess::begin_trial(SessionTime now, const SessionControl& control) {
    node_.start_trial(control);
    needle_flow_.expect_from(now + first_answer_within(control) + kPeerTimeout);  // the master starts last
    next_hold_ = needle_flow_.last_accepted() + kPeerTimeout;
    next_beep_ = kNever;
    beeps_left_ = 0;
}

void SlaveProcess::end_trial(SessionTime now) {
    stale_record_.end(now);
    send(now, node_.hold());
    node_.end_trial();
}

void SlaveProcess::obey(SessionTime /*now*/, const SessionControl& control) {
    if (control.kind == ControlKind::kFixtureChange) node_.change_fixture(control);
}

void SlaveProcess::work(SessionTime now) {
    if (node_.waves()) {
        needle_flow_.drain<NeedleWave>(
            now, *channels_.needle_in, running(), trial(),
            [&](const Header& header, const NeedleWave& message) {
                const auto take = node_.two_port() ? &SlaveNode::on_two_port : &SlaveNode::on_wave;
                answer(now, (node_.*take)(header.send_time, header.sequence, message));
            });
    } else {
        needle_flow_.drain<NeedleCommand>(
            now, *channels_.needle_in, running(), trial(),
            [&](const Header& header, const NeedleCommand& command) {
                answer(now, node_.on_needle(header.send_time, header.sequence, command));
            });
    }
    if (running() && now >= next_hold_) {
        stale_record_.watch(now, trial(), true);
        send(now, node_.hold());
        next_hold_ = now + settings_.stale_after;
    }
    if (running() && now >= next_beep_) send_beep(now);
}

void SlaveProcess::answer(SessionTime now, const ForceFeedback& feedback) {
    stale_record_.watch(now, trial(), false);
    send(now, feedback);  // hold time 0: answered in the tick of its arrival
    next_hold_ = now + settings_.stale_after;
    if (node_.take_beep()) {
        beeps_left_ = kBeeps;
        send_beep(now);
    }
}

void SlaveProcess::send(SessionTime now, const ForceFeedback& feedback) {
    if (!node_.waves()) return force_flow_.send(now, trial(), feedback);
    wave_flow_.send(now, trial(), ForceWave{feedback, node_.wave_burst()});
    force_flow_beside_waves_.send(now, trial(), feedback);
}

void SlaveProcess::send_beep(SessionTime now) {
    SessionControl beep;
    beep.kind = ControlKind::kBeep;
    beep_flow_.send(now, trial(), beep);
    next_beep_ = --beeps_left_ > 0 ? now + kBeepInterval : kNever;
}

}  // namespace thimble
