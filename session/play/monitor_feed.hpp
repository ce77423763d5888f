// The state of a session for an experimenter's view or a player's panel: newest record, nodes' reports, clocks. It is undelayed and has the fixture. It only reads, so an observer changes no result.
#pragma once

#include <cstdint>

#include "common/flow.hpp"
#include "session/run/session_process.hpp"

namespace thimble {

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
Monitor make_monitor(SessionTime now, const SessionProcess& session, const MonitorContext& context);

class MonitorFeed {
  public:
    // All outlive the feed. `instance`: random per program start. `out`: every view hears the same.
    MonitorFeed(std::uint64_t instance, std::initializer_list<Channel*> out, const SessionProcess& session)
        : flow_(Role::kSession, instance, out), session_(&session) {}

    // Sends what is due, and ten times a second why a device has ended the trial. It sends the newest state and repeats no missed one.
    void tick(SessionTime now, const MonitorContext& context);
    SessionTime next_wakeup() const { return next_; }

  private:
    OutboundFlow flow_;
    void say_fault(SessionTime now);

    const SessionProcess* session_;
    SessionTime next_{}, next_fault_{};
    bool faulty_ = false;
};

}  // namespace thimble
