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
                 {ports.outlet(Port::kNetemForceCutaneous), ports.outlet(Port::kNetemForceVisual)}),
      to_record_(Role::kSlaveSim, instance, {ports.outlet(Port::kSessionRecord)}),
      to_eyes_(Role::kSlaveSim, instance, {ports.outlet(Port::kVisualScene)}),
      fill_(settings.codec, settings.control.scale.sample_period),
      gate_master_(settings.codec, settings.control.scale.sample_period, true),
      gate_others_(settings.codec, settings.control.scale.sample_period, false),
      stale_after_(settings.stale_after),
      node_(settings) {
    join_stop_bus(ports);
}

void SlaveProcess::begin_trial(SessionTime now, const SessionControl& control) {
    node_.start_trial(control);
    fill_.reset();
    gate_master_.reset();
    gate_others_.reset();
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
            now, *needle_in_, running(), trial(),
            [&](const Header& header, const NeedleWave& message) { hear(now, header, message); });
    } else {
        needle_flow_.drain<NeedleCommand>(now, *needle_in_, running(), trial(),
                                          [&](const Header& header, const NeedleCommand& command) {
                                              hear(now, header, {command, {}});
                                          });
    }
    if (running() && now >= fill_.next()) {
        const NeedleFill::Sample* const sample = fill_.take(now);
        if (sample != nullptr && sample->moves) {
            answer(now, sample->stamp, sample->sequence, sample->message);
        } else if (sample != nullptr) {
            send(now, node_.still(sample->stamp));
        }
    }
    if (running() && now >= next_hold_) {
        stale_record_.watch(now, trial(), true);
        send(now, node_.hold());
        fill_.pause();
        next_hold_ = now + stale_after_;
    }
    if (running() && now >= next_beep_) send_beep(now);
}

void SlaveProcess::hear(SessionTime now, const Header& header, const NeedleWave& message) {
    stale_record_.watch(now, trial(), false);
    next_hold_ = now + stale_after_;
    if (fill_.heard(now, header, message)) answer(now, header.send_time, header.sequence, message);
}

void SlaveProcess::answer(SessionTime now, SessionTime stamp, std::uint32_t sequence,
                          const NeedleWave& message) {
    // hold time 0: answered in the tick of its arrival, or of the sample that stands for it
    send(now, node_.waves() ? node_.on_wave(stamp, sequence, message)
                            : node_.on_needle(stamp, sequence, message.command));
    if (node_.take_beep()) {
        beeps_left_ = kBeeps;
        send_beep(now);
    }
}

void SlaveProcess::send(SessionTime now, const ForceFeedback& feedback) {
    if (gate_master_.due(now, feedback)) {
        if (node_.waves()) {
            to_master_.send(now, trial(), ForceWave{feedback, node_.wave_burst()});
        } else {
            to_master_.send(now, trial(), feedback);
        }
    }
    if (gate_others_.due(now, feedback)) to_others_.send(now, trial(), feedback);
    to_record_.send(now, trial(), feedback);
    to_eyes_.send(now, trial(), feedback);
}

void SlaveProcess::send_beep(SessionTime now) {
    SessionControl beep;
    beep.kind = ControlKind::kBeep;
    to_eyes_.send(now, trial(), beep);
    next_beep_ = --beeps_left_ > 0 ? now + kBeepInterval : kNever;
}

}  // namespace thimble
