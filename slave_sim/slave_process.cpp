#include "slave_sim/slave_process.hpp"

namespace thimble {
namespace {

// UDP may lose a datagram, and a beep is not acknowledged. So it is sent again, and a second one is harmless.
constexpr int kBeeps = 5;
constexpr Duration kBeepInterval = std::chrono::milliseconds{20};

}  // namespace

SlaveProcess::SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, Ports& ports)
    : NodeProcess(Role::kSlaveSim, instance, *ports.between(Port::kSlaveControl, Port::kSessionSlave)),
      needle_in_(ports.inlet(Port::kSlaveNeedle)),
      to_master_(Role::kSlaveSim, instance, {ports.outlet(Port::kNetemForceMaster)}),
      to_others_(Role::kSlaveSim, instance,
                 {ports.outlet(Port::kNetemForceCutaneous), ports.outlet(Port::kNetemForceVisual),
                  ports.outlet(Port::kSessionRecord)}),
      to_eyes_(Role::kSlaveSim, instance, {ports.outlet(Port::kVisualScene)}),
      stale_after_(settings.stale_after),
      node_(settings) {
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
            now, *needle_in_, running(), trial(), [&](const Header& header, const NeedleWave& message) {
                answer(now, node_.on_wave(header.send_time, header.sequence, message));
            });
    } else {
        needle_flow_.drain<NeedleCommand>(
            now, *needle_in_, running(), trial(), [&](const Header& header, const NeedleCommand& command) {
                answer(now, node_.on_needle(header.send_time, header.sequence, command));
            });
    }
    if (running() && now >= next_hold_) {
        stale_record_.watch(now, trial(), true);
        send(now, node_.hold());
        next_hold_ = now + stale_after_;
    }
    if (running() && now >= next_beep_) send_beep(now);
}

void SlaveProcess::answer(SessionTime now, const ForceFeedback& feedback) {
    stale_record_.watch(now, trial(), false);
    send(now, feedback);  // hold time 0: answered in the tick of its arrival
    next_hold_ = now + stale_after_;
    if (node_.take_beep()) {
        beeps_left_ = kBeeps;
        send_beep(now);
    }
}

void SlaveProcess::send(SessionTime now, const ForceFeedback& feedback) {
    if (node_.waves()) {
        to_master_.send(now, trial(), ForceWave{feedback, node_.wave_burst()});
    } else {
        to_master_.send(now, trial(), feedback);
    }
    to_others_.send(now, trial(), feedback);
    to_eyes_.send(now, trial(), feedback);
}

void SlaveProcess::send_beep(SessionTime now) {
    SessionControl beep;
    beep.kind = ControlKind::kBeep;
    to_eyes_.send(now, trial(), beep);
    next_beep_ = --beeps_left_ > 0 ? now + kBeepInterval : kNever;
}

}  // namespace thimble
