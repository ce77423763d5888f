// The state of a session for an experimenter's view or a player's panel: newest record, nodes' reports, clocks. It is
// undelayed and has the fixture. It only reads, so an observer changes no result.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/flow.hpp"
#include "session/run/session_process.hpp"

namespace thimble {

inline constexpr Duration kFaultPeriod = std::chrono::milliseconds{100};

inline void fill_in_newest(Monitor& monitor, const SessionProcess& session) {
    const ForceFeedback* newest = session.recorder().newest();
    const TrialRecord& record = session.record();
    if (!record.samples.empty()) monitor.time_s = record.samples.back().time_s;
    if (newest == nullptr) return;
    copy_state(*newest, monitor);
    monitor.needle_held = newest->needle_held;
}

inline void fill_in_nodes(Monitor& monitor, const SessionProcess& session) {
    for (const Role role : kNodeRoles) {
        monitor.accepted += session.peer(role).newest().accepted;
        monitor.refused += session.peer(role).newest().refused;
    }
    const Heartbeat& master = session.peer(Role::kMaster).newest();
    monitor.force_hand_N = master.force_hand_N;
    monitor.energy_in_J = master.energy_in_J;
    monitor.round_trip_s = master.round_trip_median_s;
}

inline void fill_in_one_way(SessionTime now, Monitor& monitor, const SessionProcess& session) {
    const ForceFeedback* newest = session.recorder().newest();
    const auto slave = session.clock_of(Role::kSlaveSim).at(now);
    const auto master = session.clock_of(Role::kMaster).at(now);
    if (newest == nullptr || newest->needle_held || !slave || !master || monitor.round_trip_s == 0) return;
    const OffsetInterval ahead = between(*slave, *master);
    const double needle_s =
        to_seconds(session.recorder().newest_sent() - newest->echo_time) - ahead.offset_s();
    monitor.one_way_s = std::max(0.0, monitor.round_trip_s - needle_s - to_seconds(newest->hold_time));
    monitor.one_way_bound_s = ahead.bound_s();
}

// 250 Hz: four per frame of a screen, so that no frame waits for one.
inline constexpr Duration kMonitorPeriod = std::chrono::milliseconds{4};

// Facts that the session itself does not have.
struct MonitorContext {
    std::uint32_t trials = 0;  // planned; 0: no plan
    bool paused = false;
};

// One way from slave_sim to master = round trip - way of the needle - hold. The round trip is the master's own; the
// needle's way is slave_sim's stamp of its newest answer minus the master's stamp that it echoes, minus the difference of
// their clocks (clock_prober.hpp), which also gives the bound. The two samples are at most a heartbeat apart.
inline Monitor make_monitor(SessionTime now, const SessionProcess& session, const MonitorContext& context) {
    const TrialRecord& record = session.record();
    Monitor monitor;
    monitor.position_fixture_m = record.conditions.fixture_position_m;
    monitor.subject = record.conditions.subject;
    monitor.modality = record.conditions.modality;
    monitor.reason = record.reason;
    monitor.state = session.running() ? NodeState::kRunning : NodeState::kIdle;
    monitor.beeped = session.number() != 0 && !std::isnan(record.beep_time_s);
    monitor.network_delay_s = session.delay_s();
    monitor.network = session.network();
    monitor.trials = context.trials;
    monitor.paused = context.paused;
    fill_in_newest(monitor, session);
    fill_in_nodes(monitor, session);
    fill_in_one_way(now, monitor, session);
    return monitor;
}

class MonitorFeed {
  public:
    // All outlive the feed. `instance`: random per program start. `out`: every view hears the same.
    MonitorFeed(std::uint64_t instance, std::initializer_list<Channel*> out, const SessionProcess& session)
        : flow_(Role::kSession, instance, out), session_(&session) {}

    // Sends what is due, and ten times a second why a device has ended the trial. It sends the newest state and repeats no missed one.
    void tick(SessionTime now, const MonitorContext& context) {
        say_fault(now);
        if (now < next_) return;
        next_ = std::max(next_ + kMonitorPeriod, now + kMonitorPeriod / 2);
        flow_.send(now, session_->number(), make_monitor(now - ahead_, *session_, context));
    }

    // As Observer::serve().
    void serve(const SessionProcess& session, Duration ahead) {
        session_ = &session;
        ahead_ = ahead;
    }

    SessionTime next_wakeup() const { return next_; }

  private:
    OutboundFlow flow_;
    // Sent at once, because the session may be about to end.
    void say_fault(SessionTime now) {
        const bool faulty = session_->record().reason == EndReason::kDeviceFault;
        if (faulty && (!faulty_ || now >= next_fault_)) {
            flow_.send(now, session_->number(), DeviceFault(session_->record().fault));
            next_fault_ = now + kFaultPeriod;
        }
        faulty_ = faulty;
    }

    const SessionProcess* session_;
    Duration ahead_{};
    SessionTime next_{}, next_fault_{};
    bool faulty_ = false;
};

}  // namespace thimble
