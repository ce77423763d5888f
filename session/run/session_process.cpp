#include "session/run/session_process.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

constexpr Duration kResend = std::chrono::milliseconds{50};
// A node that says "my peer is silent" is right about the silence. The lost peer is the node that the session has not
// heard for some heartbeats.
constexpr Duration kSuspicious = std::chrono::milliseconds{250};

SessionProcess::Channels open_channels(Ports& ports) {
    SessionProcess::Channels channels{};
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
        channels.control[i] = ports.between(kNodes[i].session_end, kNodes[i].node_end);
    }
    channels.record = ports.inlet(Port::kSessionRecord);
    return channels;
}

}  // namespace

SessionProcess::SessionProcess(std::uint64_t instance, const SessionSettings& settings, Ports& ports)
    : SessionProcess(instance, settings, open_channels(ports)) {
    join_stop_bus(*ports.inlet(Port::kSessionStop), stop_outlets(ports));
}

SessionProcess::SessionProcess(std::uint64_t instance, const SessionSettings& settings,
                               const Channels& channels)
    : settings_(settings),
      record_channel_(channels.record),
      peers_(instance, channels.control),
      recorder_(settings),
      network_(settings),
      stop_(Role::kSession, instance) {}

void SessionProcess::start(const TrialConditions& conditions, std::uint32_t number) {
    recorder_.begin(conditions);
    if (!network_.name().empty()) recorder_.add(network_.event(0, true));
    for (NodePeer& peer : peers_) peer.forget_trial();
    order_ = start_order(conditions);
    order_.network_delay_s = to_seconds(network_.both_ways());
    trial_ = number;
    fresh_ = true;
    fixture_changed_ = false;
    abort_.reset();
    page_.remove();
    next_send_ = {};
    stage_ = Stage::kStartingOthers;
}

void SessionProcess::abort(EndReason reason, Role lost_peer) {
    if (!under_way()) return;
    abort_ = reason;
    abort_peer_ = lost_peer;
    next_send_ = {};
}

void SessionProcess::change_fixture(bool present, double fixture_position_m) {
    order_.fixture_present = present;
    order_.fixture_position_m = fixture_position_m;
    fixture_changed_ = true;
    next_send_ = {};
}

void SessionProcess::change_delay(Duration one_way) {
    if (network_.change_delay(one_way)) network_changed(false);
}

bool SessionProcess::change_network(const NetworkName& name) {
    if (built_in_profile(name.view()) == nullptr) return false;
    if (network_.change_profile(name)) network_changed(true);
    return true;
}

void SessionProcess::network_changed(bool profile) {
    network_changed_ = network_fresh_ = true;
    next_send_ = {};
    if (under_way()) recorder_.add(network_.event(recorder_.newest_time_s(), profile));
}

void SessionProcess::emergency_stop(SessionTime now, std::string_view words) {
    stop_.stop(now, EndReason::kEmergencyStop, words);
    next_send_ = {};
}

void SessionProcess::release_stop(SessionTime now) {
    stop_.release(now);
    next_send_ = {};
}

void SessionProcess::shut_down(SessionTime now) {
    SessionControl order;
    order.kind = ControlKind::kShutdown;
    for (NodePeer& peer : peers_) peer.send(now, trial_, order);
}

void SessionProcess::tick(SessionTime now) {
    ticks_.tick(now);
    excuse_standstill();
    stop_.tick(now);
    take_messages(now);
    take_records(now);
    if (fresh_) {
        fresh_ = false;
        enter(now, Stage::kStartingOthers);
    }
    obey_stop(now);
    if (abort_ && stage_ != Stage::kEnding && stage_ != Stage::kDone) end(now, *abort_, abort_peer_);
    advance(now);
    if (now >= next_send_) send_orders(now);
}

// Each of a tick's parts is called in one place: the compiler makes one function of them.
inline void SessionProcess::excuse_standstill() {
    if (ticks_.stood_still() == Duration{}) return;  // the usual case
    for (NodePeer& peer : peers_) peer.did_not_listen(ticks_.stood_still());
    record_flow_.did_not_listen(ticks_.stood_still());
}

// Also a trial that was to begin: it is in the record as one that was stopped, and no node has heard of it.
inline void SessionProcess::obey_stop(SessionTime now) {
    if (!stop_.stopped() || !under_way() || stage_ == Stage::kEnding) return;
    end(now, stop_.reason(), stop_.raised_by(), stop_.words());
}

inline void SessionProcess::take_messages(SessionTime now) {
    for (NodePeer& peer : peers_) {
        while (const Message* message = peer.receive(now)) {
            heard_ = true;
            take(now, peer, *message);
        }
    }
}

void SessionProcess::take(SessionTime now, NodePeer& peer, const Message& message) {
    if (const auto* reply = std::get_if<ClockReply>(&message.body)) {
        const auto exchange = peer.take(now, message.header, *reply);
        if (exchange && clock_hook_) clock_hook_(peer.role(), *exchange);
    } else if (const auto* order = std::get_if<Order>(&message.body)) {
        const std::optional<Refusal> refusal = judge_request(peer, message.header.trial, *order);
        if (!refusal) order->kind == OrderKind::kAnswer ? page_.answer(order->value) : page_.go_on();
        if (refusal) peer.refuse(*refusal);
    } else if (!peer.take(message)) {
        peer.refuse(Refusal::kUnexpectedKind);
    }
}

// `trial`: the newest that the subject's window has seen; 0: none since its program started. A late request is not for the next
// page. None: it holds.
std::optional<Refusal> SessionProcess::judge_request(const NodePeer& peer, std::uint32_t trial,
                                                     const Order& order) const {
    const bool goes_on = order.kind == OrderKind::kResume && settings_.subject_goes_on && page_.waits();
    const bool answers = order.kind == OrderKind::kAnswer && page_.asks(order.trial);
    if (peer.role() != Role::kVisual || under_way() || (!goes_on && !answers))
        return Refusal::kUnexpectedKind;
    const bool newest = trial == 0 || trial == std::max(trial_, last_number());
    return newest ? std::nullopt : std::optional{Refusal::kWrongTrial};
}

inline void SessionProcess::take_records(SessionTime now) {
    const bool recording = stage_ == Stage::kStartingMaster || stage_ == Stage::kRunning;
    record_flow_.drain<ForceFeedback>(now, *record_channel_, recording, trial_,
                                      [&](const Header& header, const ForceFeedback& feedback) {
                                          const TrialConditions& conditions = record().conditions;
                                          if (recorder_.add(header, feedback) && conditions.removes_fixture)
                                              change_fixture(false, conditions.fixture_position_m);
                                      });
}

bool SessionProcess::all_stopped(SessionTime now) const {
    const EndReason reason = record().reason;
    const bool lost = reason == EndReason::kPeerLost;
    const bool cut_off =
        lost || is_stop(reason) || reason == EndReason::kInterrupted || reason == EndReason::kDeviceFault;
    return std::all_of(peers_.begin(), peers_.end(), [&](const NodePeer& peer) {
        // Lost nodes do not acknowledge, nor do nodes without this trial.
        if (!peer.told() || (lost && peer.role() == record().lost_peer)) return true;
        if (cut_off && peer.silent_for(now, kPeerTimeout)) return true;
        if (peer.trial() != trial_) return false;
        return peer.newest().state == NodeState::kIdle || peer.newest().state == NodeState::kFailed;
    });
}

// The others start before the master, so that its first sample finds all nodes ready.
inline void SessionProcess::advance(SessionTime now) {
    switch (stage_) {
        case Stage::kStartingOthers:
            if (peers_.all_run(trial_, false)) enter(now, Stage::kStartingMaster);
            break;
        case Stage::kStartingMaster:
            if (!peers_.all_run(trial_, true)) break;
            record_flow_.expect_from(now + network_.both_ways());
            enter(now, Stage::kRunning);
            break;
        case Stage::kEnding:
            if (all_stopped(now) || now - stage_since_ > settings_.peer_wait) finish();
            return;
        case Stage::kRunning:
            watch(now);
            return;
        case Stage::kIdle:
        case Stage::kDone:
            return;
    }
    if (end_with_fault(now)) return;
    if (starting() && now - stage_since_ > settings_.peer_wait) {
        const bool with_master = stage_ == Stage::kStartingMaster;
        end(now, EndReason::kPeerLost, peers_.slowest_node(now, trial_, with_master).role());
    }
}

bool SessionProcess::end_with_fault(SessionTime now) {
    for (const NodePeer& peer : peers_) {
        const DeviceFault* fault = peer.fault(trial_);
        if (fault == nullptr) continue;
        end(now, peer.newest().reason, peer.role(), fault->words());
        return true;
    }
    return false;
}

inline void SessionProcess::watch(SessionTime now) {
    if ((heard_ || now > nobody_silent_until_) && end_by_node(now)) return;
    if (settings_.ends_by_withdrawal && recorder_.withdrawn()) return end(now, EndReason::kCompleted);
    // The record flow was interrupted, so the record has a gap: the trial ends.
    if (record_flow_.lost_for(now, kPeerTimeout)) return end(now, EndReason::kPeerLost, Role::kSlaveSim);
    if (now - stage_since_ > settings_.trial_timeout) end(now, EndReason::kTimeout);
}

// Ends the trial if a node has failed, has finished, or is silent.
bool SessionProcess::end_by_node(SessionTime now) {
    const bool heard = std::exchange(heard_, false);
    if (heard && end_with_fault(now)) return true;
    const NodePeer& quiet = peers_.quietest();
    nobody_silent_until_ = quiet.last_heard() + kPeerTimeout;
    if (!quiet.silent_for(now, kPeerTimeout)) return heard && end_as_told(now, quiet);
    end(now, EndReason::kPeerLost, quiet.role());
    return true;
}

// Ends the trial if a node has finished, or misses a peer.
bool SessionProcess::end_as_told(SessionTime now, const NodePeer& quiet) {
    for (const NodePeer& peer : peers_) {
        if (peer.misses_peer(trial_)) {
            // Of two peers: after a standstill of this program both have been heard anew, or neither.
            const bool silent = peer.last_heard() - quiet.last_heard() > kSuspicious;
            end(now, EndReason::kPeerLost, silent ? quiet.role() : peer.role());
            return true;
        }
        if (peer.trial() == trial_ && peer.newest().state == NodeState::kFinished) {
            end(now, EndReason::kCompleted);
            return true;
        }
    }
    return false;
}

void SessionProcess::enter(SessionTime now, Stage stage) {
    stage_ = stage;
    heard_ = true;
    stage_since_ = now;
    next_send_ = now;
}

void SessionProcess::end(SessionTime now, EndReason reason, Role lost_peer, std::string_view fault) {
    recorder_.end(
        reason, lost_peer,
        reason == EndReason::kPeerLost ? peers_.silence(now, lost_peer, trial_) : std::string(fault));
    order_.kind = ControlKind::kTrialEnd;
    order_.reason = reason;
    enter(now, Stage::kEnding);
    send_orders(now);  // at least once: a silent node may still hear it
}

void SessionProcess::finish() {
    stage_ = Stage::kDone;
    const NodePeer& master = peer(Role::kMaster);
    if (master.trial() == trial_ && master.newest().state != NodeState::kRunning)
        recorder_.add_round_trip(master.newest());
}

void SessionProcess::send_orders(SessionTime now) {
    const bool busy = starting() || stage_ == Stage::kEnding;
    next_send_ = now + (busy ? kResend : kHeartbeatPeriod);
    const bool tells = network_changed_ && !busy;
    if (tells && std::exchange(network_fresh_, false))
        record_flow_.excuse_silence_until(now + network_.both_ways());
    for (NodePeer& peer : peers_) {
        send_order(now, peer);
        if (tells) peer.send(now, trial_, network_.order(order_));
        const bool has_page = peer.role() == Role::kVisual && !under_way() && page_.shown() != nullptr;
        if (has_page) peer.send(now, trial_, *page_.shown());
        // A probe follows an order, so that it wakes no idle node.
        peer.send_probe_if_due(now, trial_);
    }
}

void SessionProcess::send_order(SessionTime now, NodePeer& peer) {
    const bool its_turn = stage_ == Stage::kEnding || stage_ == Stage::kStartingMaster ||
                          (stage_ == Stage::kStartingOthers && peer.role() != Role::kMaster);
    if (its_turn) {
        if (starting()) peer.tell();
        peer.send(now, trial_, order_);
    } else if (stage_ == Stage::kRunning && fixture_changed_ && peer.role() == Role::kSlaveSim) {
        SessionControl change = order_;
        change.kind = ControlKind::kFixtureChange;
        peer.send(now, trial_, change);
    } else {
        peer.send(now, trial_, Heartbeat{});
    }
}

}  // namespace thimble
