// The session's side of a trial: starts it on all five nodes, records every answer of slave_sim, detects lost nodes,
// and ends the trial. It only steers; no haptic data passes through it. It has no clock of its own, so any loop can
// drive it.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include "common/node_process.hpp"
#include "session/run/node_peers.hpp"
#include "session/run/session_network.hpp"
#include "session/run/subject_page.hpp"
#include "session/run/trial_recorder.hpp"

namespace thimble {

class SessionProcess final : public Process {
  public:
    struct Channels {
        std::array<Channel*, kNodeRoles.size()> control;  // in the order of kNodeRoles
        Channel* record;                                  // from slave_sim
    };
    // Called for each exchange of stamps with the clock of a node.
    using ClockHook = std::function<void(Role, const ClockExchange&)>;

    SessionProcess(std::uint64_t instance, const SessionSettings& settings, const Channels& channels);
    // Opens its channels.
    SessionProcess(std::uint64_t instance, const SessionSettings& settings, Ports& ports);
    void set_sample_hook(TrialRecorder::SampleHook hook) { recorder_.set_sample_hook(std::move(hook)); }
    void set_clock_hook(ClockHook hook) { clock_hook_ = std::move(hook); }

    // Starts a trial with the next tick; none may be running. `number` tells the trials apart on the wire: it
    // must differ from the last one that the same nodes saw. It also keys the virtual operator's draws.
    void start(const TrialConditions& conditions, std::uint32_t number);
    void start(const TrialConditions& conditions) { start(conditions, conditions.trial); }
    // Ends the running trial (interrupt, a child process that died). Harmless when none runs.
    void abort(EndReason reason, Role lost_peer = Role::kSession);
    // Removes or moves the fixture of the running trial. A trial that removes it does so by itself, when the
    // sample arrives that the beep is due with.
    void change_fixture(bool present, double fixture_position_m);
    // The force path's delay, one way, from now on and in the trials to come. Said again with each heartbeat.
    void change_delay(Duration one_way);
    // Both ways of a profile that comes with the program, its delay included, likewise. False: there is none of this name,
    // nothing changes.
    bool change_network(const NetworkName& name);
    // Tells every node to exit.
    void shut_down(SessionTime now);

    // The subject's screen shows this page from now until a trial starts. Every keep-alive repeats it.
    void show(const Page& page) { page_.show(page); }
    // Whether the subject has asked to go on from the page that is shown, since the last call.
    bool take_go_on() { return page_.take_go_on(); }
    // The subject's answer to the question that is shown, likewise.
    std::optional<double> take_answer() { return page_.take_answer(); }

    // The stop bus: everything here ends with it, and nothing begins while it holds (stop_bus.hpp).
    void join_stop_bus(Channel& in, const StopOutlets& out) { stop_.connect(in, out); }
    void emergency_stop(SessionTime now, std::string_view words);
    void release_stop(SessionTime now);
    const StopBus& stop_bus() const { return stop_; }

    // State for an observer of the session.
    bool finished() const { return stage_ == Stage::kDone; }
    bool running() const { return stage_ == Stage::kRunning; }
    std::uint32_t number() const { return trial_; }  // of the newest trial, on the wire
    const TrialRecorder& recorder() const { return recorder_; }
    const TrialRecord& record() const { return recorder_.record(); }
    double delay_s() const { return network_.force_delay_s(); }  // of the force path, one way, as asked now
    const NetworkName& network() const { return network_.name(); }  // empty: the settings' own
    const NodePeer& peer(Role role) const { return peers_.of(role); }
    // Offset of each node's clock to the session's (clock_prober.hpp).
    const ClockFilter& clock_of(Role role) const { return peer(role).prober().filter(); }
    // The greatest number that a node has reported, 0 if none ran a trial yet.
    std::uint32_t last_number() const { return peers_.last_number(); }
    // Roles that have not been heard within `limit`, as text; empty if all are there.
    std::string missing_peers(SessionTime now, Duration limit) const { return peers_.missing(now, limit); }

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return std::min(next_send_, stop_.next()); }
    bool stopped() const override { return false; }

  private:
    enum class Stage { kIdle, kStartingOthers, kStartingMaster, kRunning, kEnding, kDone };

    void excuse_standstill();
    void take_messages(SessionTime now);
    void take(SessionTime now, NodePeer& peer, const Message& message);
    std::optional<Refusal> judge_request(const NodePeer& peer, std::uint32_t trial, const Order& order) const;
    void take_records(SessionTime now);
    void advance(SessionTime now);
    bool end_with_fault(SessionTime now);
    bool end_by_node(SessionTime now);
    bool end_as_told(SessionTime now, const NodePeer& quiet);
    void obey_stop(SessionTime now);
    void watch(SessionTime now);
    void send_orders(SessionTime now);
    void send_order(SessionTime now, NodePeer& peer);
    void network_changed(bool profile);
    void enter(SessionTime now, Stage stage);
    void end(SessionTime now, EndReason reason, Role lost_peer = Role::kSession, std::string_view fault = {});
    void finish();
    bool under_way() const { return stage_ != Stage::kIdle && stage_ != Stage::kDone; }
    bool starting() const { return stage_ == Stage::kStartingOthers || stage_ == Stage::kStartingMaster; }
    bool all_stopped(SessionTime now) const;

    SessionSettings settings_;
    Channel* record_channel_;
    NodePeers peers_;
    InboundFlow record_flow_{Role::kSlaveSim};
    TrialRecorder recorder_;
    SessionNetwork network_;
    bool network_changed_ = false;  // since the session began
    bool network_fresh_ = false;    // and no node has heard of it yet
    SubjectPage page_;
    StopBus stop_;
    ClockHook clock_hook_;
    SessionControl order_;
    Stage stage_ = Stage::kIdle;
    std::uint32_t trial_ = 0;
    bool fresh_ = false;  // start() was called, the clock is not known yet
    std::optional<EndReason> abort_;
    Role abort_peer_ = Role::kSession;
    TickTimes ticks_;
    SessionTime stage_since_{};
    SessionTime next_send_{};
    SessionTime nobody_silent_until_{};
    bool heard_ = true;  // a node, since the stage began or watch() last looked at what they say
    bool fixture_changed_ = false;
};

}  // namespace thimble
