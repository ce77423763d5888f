// The session's side of a trial: starts it on all five nodes, records every answer of slave_sim, watches that
// everybody lives, and ends it. It steers and records; nothing of the haptic loop passes through it.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/flow.hpp"
#include "common/node_process.hpp"
#include "session/clocks/clock_filter.hpp"
#include "session/clocks/clock_prober.hpp"
#include "session/records/trial_record.hpp"
#include "session/settings/session_settings.hpp"

namespace thimble {

inline constexpr std::array kNodeRoles{Role::kNetem, Role::kSlaveSim, Role::kCutaneous, Role::kVisual,
                                       Role::kMaster};

inline constexpr Duration kWithdrawnFor = std::chrono::milliseconds{300};

class SessionProcess final : public Process {
  public:
    struct Channels {
        std::array<Channel*, kNodeRoles.size()> control;  // in the order of kNodeRoles
        Channel* record;                                  // from slave_sim
    };
    // Called for each recorded sample, before it is stored (to write it to disk as it comes).
    using SampleHook = std::function<void(const TrajectorySample&)>;
    // Called for each exchange of stamps with the clock of a node.
    using ClockHook = std::function<void(Role, const ClockExchange&)>;

    SessionProcess(std::uint64_t instance, const SessionSettings& settings, const Channels& channels);
    // Opens its channels.
    SessionProcess(std::uint64_t instance, const SessionSettings& settings, Ports& ports);

    // Starts a trial with the next tick; none may be running. `number` tells the trials apart on the wire: it
    // must differ from the last one that the same nodes saw. It also keys the virtual operator's draws.
    void start(const TrialConditions& conditions, std::uint32_t number);
    void start(const TrialConditions& conditions) { start(conditions, conditions.trial); }
    // The greatest number that a node has reported, 0 if none ran a trial yet.
    std::uint32_t last_number() const;
    void set_sample_hook(SampleHook hook) { hook_ = std::move(hook); }
    void set_clock_hook(ClockHook hook) { clock_hook_ = std::move(hook); }
    // Offset of each node's clock to the session's (clock_filter.hpp).
    const ClockFilter& clock_of(Role role) const { return peer(role).clock; }
    const ClockProbeCounters& clock_counters(Role role) const { return peer(role).prober.counters(); }

    bool finished() const { return stage_ == Stage::kDone; }
    // State for a view of the session.
    bool running() const { return stage_ == Stage::kRunning; }
    std::uint32_t number() const { return trial_; }  // of the newest trial, on the wire
    const Heartbeat& heartbeat_of(Role role) const { return peer(role).last; }
    double delay_s() const { return delay_s_; }  // of the force path, one way, as asked now
    // Newest answer of slave_sim in this trial and when it left there, on its clock; null before the first one.
    const ForceFeedback* newest() const { return heard_record_ ? &newest_ : nullptr; }
    SessionTime newest_sent() const { return newest_sent_; }
    const TrialRecord& record() const { return record_; }

    // The stop bus: everything here ends with it, and nothing begins while it holds (stop_bus.hpp).
    void join_stop_bus(Channel& in, const StopOutlets& out) { stop_.connect(in, out); }
    void emergency_stop(SessionTime now, std::string_view words) {
        stop_.stop(now, EndReason::kEmergencyStop, words);
        next_send_ = {};
    }
    void release_stop(SessionTime now) {
        stop_.release(now);
        next_send_ = {};
    }
    const StopBus& stop_bus() const { return stop_; }

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
    const NetworkName& network() const { return network_; }  // empty: the settings' own
    // What the subject's screen says from now until a trial starts; repeated with every keep-alive.
    void show(const Page& page);
    // Whether the subject has asked to go on from the page that is shown, since the last call.
    bool take_go_on() { return std::exchange(go_on_, false); }
    // The messages of this node: accepted, and refused by reason.
    const FlowCounters& heard_from(Role role) const { return peer(role).flow.counters(); }
    // Tells every node to exit.
    void shut_down(SessionTime now);
    // Roles that have not been heard within `limit`, as text; empty if all are there.
    std::string missing_peers(SessionTime now, Duration limit) const;

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return std::min(next_send_, stop_.next()); }
    bool stopped() const override { return false; }

  private:
    enum class Stage { kIdle, kStartingOthers, kStartingMaster, kRunning, kEnding, kDone };
    struct Peer {
        InboundFlow flow;
        OutboundFlow out;
        Channel* channel;
        Role role;
        Heartbeat last;
        std::optional<DeviceFault> fault;  // said in this trial, of a device or a stop
        std::uint32_t trial = 0;
        bool told = false;  // to begin this trial
        ClockProber prober{};
        ClockFilter clock{};
    };

    void take_heartbeats(SessionTime now);
    void take_clock(SessionTime now, Peer& peer, const Header& header, const ClockReply& reply);
    std::optional<Refusal> judge_request(const Peer& peer, std::uint32_t trial, const Order& order) const;
    void take_records(SessionTime now);
    void store(const Header& header, const ForceFeedback& feedback);
    void watch_withdrawal(const TrajectorySample& sample);
    void advance(SessionTime now);
    bool end_with_fault(SessionTime now);
    void obey_stop(SessionTime now);
    void watch(SessionTime now);
    void send_orders(SessionTime now);
    void tell_network();
    void note_network(double time_s, bool profile);
    SessionControl network_order() const;
    void enter(SessionTime now, Stage stage);
    void end(SessionTime now, EndReason reason, Role lost_peer = Role::kSession);
    void finish();
    bool under_way() const { return stage_ != Stage::kIdle && stage_ != Stage::kDone; }
    bool all(NodeState state, bool with_master) const;
    bool all_stopped(SessionTime now) const;
    const Peer& peer(Role role) const;
    const Peer* quietest() const;
    const Peer& laggard(SessionTime now) const;

    SessionSettings settings_;
    double delay_s_;  // as asked, one way
    NetworkName network_;
    bool network_changed_ = false;  // by either of the two
    bool network_fresh_ = false;    // and no node has heard of it yet
    Channels channels_;
    std::array<Peer, kNodeRoles.size()> peers_;
    InboundFlow record_flow_{Role::kSlaveSim};
    StopBus stop_;
    SampleHook hook_;
    ClockHook clock_hook_;
    TrialRecord record_;
    SessionControl order_;
    Stage stage_ = Stage::kIdle;
    std::uint32_t trial_ = 0;
    bool go_on_ = false;  // asked for, on the page shown
    bool fresh_ = false;  // start() was called, the clock is not known yet
    std::optional<Page> page_;
    std::optional<EndReason> abort_;
    Role abort_peer_ = Role::kSession;
    SessionTime stage_since_{};
    SessionTime next_send_{};
    SessionTime first_echo_{};
    ForceFeedback newest_;
    SessionTime newest_sent_{};
    bool heard_record_ = false;
    double free_since_s_ = 0;  // after the beep, in the record's time; NaN: in touch with the tissue
    bool withdrawn_ = false;
    bool fixture_changed_ = false;
};

}  // namespace thimble
