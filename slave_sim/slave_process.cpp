#include "slave_sim/slave_process.hpp"

#include "slave_sim/remote_needle.hpp"

namespace thimble {
namespace {

// UDP may lose a datagram, and a beep is not acknowledged. So it is sent again, and a second one is harmless.
constexpr int kBeeps = 5;
constexpr Duration kBeepInterval = std::chrono::milliseconds{20};

}  // namespace

SlaveProcess::SlaveProcess(std::uint64_t instance, const SlaveSettings& settings, Ports& ports,
                           RemoteNeedle* robot)
    : NodeProcess(Role::kSlaveSim, instance, *ports.between(Port::kSlaveControl, Port::kSessionSlave)),
      robot_(robot),
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
    if (robot_ != nullptr) robot_->start_trial(now);
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
    hold(now);
    if (robot_ != nullptr) robot_->end_trial(now);
    node_.end_trial();
}

SessionTime SlaveProcess::next_work() const {
    const SessionTime robot = robot_ == nullptr ? kNever : robot_->next_look();
    if (!running()) return robot;
    return std::min(std::min(next_hold_, next_beep_), std::min(fill_.next(), robot));
}

std::string_view SlaveProcess::device_fault() const {
    return robot_ == nullptr ? std::string_view() : robot_->fault();
}

void SlaveProcess::obey(SessionTime /*now*/, const SessionControl& control) {
    if (control.kind == ControlKind::kFixtureChange) node_.change_fixture(control);
}

void SlaveProcess::work(SessionTime now) {
    if (robot_ != nullptr) robot_->hear(now);
    if (node_.waves()) {
        needle_flow_.drain<NeedleWave>(
            now, *needle_in_, running(), trial(),
            [&](const Header& header, const NeedleWave& message) { hear(now, header, message); });
    } else {
        needle_flow_.drain<NeedleCommand>(now, *needle_in_, running(), trial(),
                                          [&](const Header& header, const NeedleCommand& command) {
                                              heard_.command = command;
                                              hear(now, header, heard_);
                                          });
    }
    if (running() && now >= fill_.next()) {
        const NeedleFill::Sample* const sample = fill_.take(now);
        if (sample != nullptr && sample->moves) {
            answer(now, sample->stamp, sample->sequence, sample->message);
        } else if (sample != nullptr) {
            send(now, robot_ == nullptr || robot_->is_felt() ? node_.still(sample->stamp) : node_.hold());
        }
    }
    if (running() && now >= next_hold_) {
        stale_record_.watch(now, trial(), true);
        hold(now);
        fill_.pause();
        next_hold_ = now + stale_after_;
    }
    if (running() && now >= next_beep_) send_beep(now);
}

// Each of a tick's parts is called in one place: the compiler makes one function of them.
inline void SlaveProcess::hear(SessionTime now, const Header& header, const NeedleWave& message) {
    stale_record_.watch(now, trial(), false);
    next_hold_ = now + stale_after_;
    if (fill_.heard(now, header, message)) answer(now, header.send_time, header.sequence, message);
}

void SlaveProcess::answer(SessionTime now, SessionTime stamp, std::uint32_t sequence,
                          const NeedleWave& message) {
    // hold time 0: answered in the tick of its arrival, or of the sample that stands for it
    send(now, moved(now, stamp, sequence, message));
    if (node_.take_beep()) {
        beeps_left_ = kBeeps;
        send_beep(now);
    }
}

inline ForceFeedback SlaveProcess::moved(SessionTime now, SessionTime stamp, std::uint32_t sequence,
                                         const NeedleWave& message) {
    if (node_.waves()) return node_.on_wave(stamp, sequence, message);
    if (robot_ == nullptr) return node_.on_needle(stamp, sequence, message.command);
    if (resting())
        return node_.hold();  // else rest() would hold it anew in each tick, a little further each time
    robot_->command(now, message.command.position_needle_m);
    if (!robot_->is_felt()) return node_.hold();
    return node_.on_robot(stamp, sequence, robot_->position_m(), robot_->force_N());
}

void SlaveProcess::hold(SessionTime now) {
    if (robot_ != nullptr) robot_->hold(now);
    send(now, node_.hold());
}

void SlaveProcess::send(SessionTime now, const ForceFeedback& feedback) {
    OutboundFlow::Verdict good;
    if (gate_master_.due(now, feedback)) {
        if (node_.waves()) {
            to_master_.send(now, trial(), ForceWave{feedback, node_.wave_burst()});
        } else {
            to_master_.send(now, trial(), feedback, good);
        }
    }
    if (gate_others_.due(now, feedback)) to_others_.send(now, trial(), feedback, good);
    to_record_.send(now, trial(), feedback, good);
    to_eyes_.send(now, trial(), feedback, good);
}

void SlaveProcess::send_beep(SessionTime now) {
    SessionControl beep;
    beep.kind = ControlKind::kBeep;
    to_eyes_.send(now, trial(), beep);
    next_beep_ = --beeps_left_ > 0 ? now + kBeepInterval : kNever;
}

}  // namespace thimble
