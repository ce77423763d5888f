#include "session/run/session_process.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "session/launch/node_kinds.hpp"

namespace thimble {
namespace {

constexpr Duration kResend = std::chrono::milliseconds{50};
// Samples still come until all nodes have heard of the end.
constexpr Duration kAfterTimeout = std::chrono::seconds{1};
// A node that says "my peer is silent" is right about the silence. The lost peer is the node that the session has not heard for some heartbeats.
constexpr Duration kSuspicious = std::chrono::milliseconds{250};

// Reasons whose text follows the heartbeat.
bool has_words(EndReason reason) { return reason == EndReason::kDeviceFault || is_stop(reason); }

template <std::size_t... I>
auto make_peers(std::uint64_t instance, const SessionProcess::Channels& channels, std::index_sequence<I...>,
                auto make) {
    return std::array{make(instance, channels.control[I], kNodeRoles[I])...};
}

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
      delay_s_(to_seconds(settings.force_delay)),
      channels_(channels),
      peers_(make_peers(instance, channels, std::make_index_sequence<kNodeRoles.size()>{},
                        [](std::uint64_t id, Channel* channel, Role role) {
                            return Peer{InboundFlow(role),
                                        OutboundFlow(Role::kSession, id, {channel}),
                                        channel,
                                        role,
                                        Heartbeat{},
                                        std::nullopt,
                                        0,
                                        false,
                                        ClockProber{},
                                        ClockFilter{}};
                        })),
      stop_(Role::kSession, instance) {}

void SessionProcess::start(const TrialConditions& conditions, std::uint32_t number) {
    record_.conditions = conditions;
    record_.conditions.compensator =
        conditions.modality == Modality::kHF ? settings_.compensator : Compensator::kNone;
    record_.samples.clear();
    record_.network_events.clear();
    if (!network_.empty()) note_network(0, true);
    record_.samples.reserve(static_cast<std::size_t>((settings_.trial_timeout + kAfterTimeout) /
                                                     std::max(settings_.sample_period, Duration{1})));
    record_.beep_time_s = record_.round_trip_s = record_.achieved_delay_s = std::nan("");
    record_.reason = EndReason::kNone;
    record_.lost_peer = Role::kSession;
    record_.fault.clear();
    for (Peer& peer : peers_) {
        peer.fault.reset();
        peer.told = false;
    }
    order_ = {};
    order_.study_seed = conditions.study_seed;
    order_.experiment = conditions.experiment;
    order_.subject = conditions.subject;
    order_.fixture_position_m = conditions.fixture_position_m;
    order_.modality = conditions.modality;
    order_.network_delay_s = to_seconds(settings_.network_delay);
    trial_ = number;
    free_since_s_ = std::nan("");
    withdrawn_ = false;
    fresh_ = true;
    fixture_changed_ = false;
    heard_record_ = false;
    abort_.reset();
    page_.reset();
    go_on_ = false;
    next_send_ = {};
    stage_ = Stage::kStartingOthers;
}

std::uint32_t SessionProcess::last_number() const {
    return std::max_element(peers_.begin(), peers_.end(),
                            [](const Peer& a, const Peer& b) { return a.trial < b.trial; })
        ->trial;
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

void SessionProcess::shut_down(SessionTime now) {
    SessionControl order;
    order.kind = ControlKind::kShutdown;
    for (Peer& peer : peers_) peer.out.send(now, trial_, order);
}

std::string SessionProcess::missing_peers(SessionTime now, Duration limit) const {
    std::string names;
    for (const Peer& peer : peers_) {
        const bool heard = peer.flow.counters().accepted > 0 && !peer.flow.silent_for(now, limit);
        if (!heard) names += (names.empty() ? "" : ", ") + std::string(to_string(peer.role));
    }
    return names;
}

void SessionProcess::tick(SessionTime now) {
    stop_.tick(now);
    take_heartbeats(now);
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

// Also a trial that was to begin: it is in the record as one that was stopped, and no node has heard of it.
void SessionProcess::obey_stop(SessionTime now) {
    if (!stop_.stopped() || !under_way() || stage_ == Stage::kEnding) return;
    record_.fault = stop_.words();
    end(now, stop_.reason(), stop_.raised_by());
}

void SessionProcess::take_heartbeats(SessionTime now) {
    for (Peer& peer : peers_) {
        while (const Message* message = peer.flow.receive(now, *peer.channel)) {
            if (const auto* heartbeat = std::get_if<Heartbeat>(&message->body)) {
                peer.last = *heartbeat;
                peer.trial = message->header.trial;
            } else if (const auto* fault = std::get_if<DeviceFault>(&message->body)) {
                peer.fault = *fault;
            } else if (const auto* reply = std::get_if<ClockReply>(&message->body)) {
                take_clock(now, peer, message->header, *reply);
            } else if (const auto* order = std::get_if<Order>(&message->body)) {
                const std::optional<Refusal> refusal = judge_request(peer, message->header.trial, *order);
                if (!refusal) go_on_ = true;
                if (refusal) peer.flow.refuse_admitted(*refusal);
            } else {
                peer.flow.refuse_admitted(Refusal::kUnexpectedKind);
            }
        }
    }
}

// `trial`: the newest that whoever asks has seen; one that comes late is not for the next page. kCount: it holds.
std::optional<Refusal> SessionProcess::judge_request(const Peer& peer, std::uint32_t trial,
                                                     const Order& order) const {
    const bool waits =
        (stage_ == Stage::kIdle || stage_ == Stage::kDone) && page_ && waits_to_go_on(page_->kind);
    if (peer.role != Role::kVisual || order.kind != OrderKind::kResume || !settings_.subject_goes_on ||
        !waits)
        return Refusal::kUnexpectedKind;
    return trial == std::max(trial_, last_number()) ? std::nullopt : std::optional{Refusal::kWrongTrial};
}

void SessionProcess::show(const Page& page) {
    if (!page_ || page_->kind != page.kind || page_->trial != page.trial) go_on_ = false;
    page_ = page;
}

void SessionProcess::take_clock(SessionTime now, Peer& peer, const Header& header, const ClockReply& reply) {
    const auto exchange = peer.prober.take(reply, header.send_time, peer.channel->arrival().value_or(now));
    if (!exchange) return;
    peer.clock.add(*exchange);
    if (clock_hook_) clock_hook_(peer.role, *exchange);
}

void SessionProcess::take_records(SessionTime now) {
    const bool recording = stage_ == Stage::kStartingMaster || stage_ == Stage::kRunning;
    record_flow_.drain<ForceFeedback>(
        now, *channels_.record, recording, trial_,
        [&](const Header& header, const ForceFeedback& feedback) { store(header, feedback); });
}

void SessionProcess::store(const Header& header, const ForceFeedback& feedback) {
    newest_ = feedback;
    newest_sent_ = header.send_time;
    heard_record_ = true;
    if (feedback.needle_held) return;
    if (record_.samples.empty()) first_echo_ = feedback.echo_time;
    TrajectorySample sample;
    sample.time_s = to_seconds(feedback.echo_time - first_echo_);
    sample.position_needle_m = feedback.position_needle_m;
    sample.position_surface_m = feedback.position_surface_m;
    sample.force_tissue_N = feedback.force_tissue_N;
    sample.force_fixture_N = feedback.force_fixture_N;
    sample.force_total_N = feedback.force_total_N;
    sample.contact_time_s = feedback.contact_time_s;
    sample.phase = feedback.phase;
    sample.fixture_present = feedback.fixture_present;
    if (std::isnan(record_.beep_time_s) && sample.contact_time_s >= to_seconds(settings_.contact_hold)) {
        record_.beep_time_s = sample.time_s;
        if (record_.conditions.removes_fixture) change_fixture(false, record_.conditions.fixture_position_m);
    }
    watch_withdrawal(sample);
    if (hook_) hook_(sample);
    record_.samples.push_back(sample);
}

// A while, not one sample: the record may return to `free` for an instant (docs/model.md).
void SessionProcess::watch_withdrawal(const TrajectorySample& sample) {
    if (std::isnan(record_.beep_time_s) || sample.phase != TissuePhase::kFree) {
        free_since_s_ = std::nan("");
        return;
    }
    if (std::isnan(free_since_s_)) free_since_s_ = sample.time_s;
    withdrawn_ = sample.time_s - free_since_s_ >= to_seconds(kWithdrawnFor);
}

bool SessionProcess::all(NodeState state, bool with_master) const {
    return std::all_of(peers_.begin(), peers_.end(), [&](const Peer& peer) {
        if (peer.role == Role::kMaster && !with_master) return true;
        return peer.trial == trial_ && peer.last.state == state;
    });
}

bool SessionProcess::all_stopped(SessionTime now) const {
    const bool lost = record_.reason == EndReason::kPeerLost;
    const bool cut_off = lost || is_stop(record_.reason) || record_.reason == EndReason::kInterrupted ||
                         record_.reason == EndReason::kDeviceFault;
    return std::all_of(peers_.begin(), peers_.end(), [&](const Peer& peer) {
        // The dead do not acknowledge, nor do those that have nothing to end.
        if (!peer.told || (lost && peer.role == record_.lost_peer)) return true;
        if (cut_off && peer.flow.silent_for(now, kPeerTimeout)) return true;
        if (peer.trial != trial_) return false;
        return peer.last.state == NodeState::kIdle || peer.last.state == NodeState::kFailed;
    });
}

const SessionProcess::Peer& SessionProcess::peer(Role role) const {
    return *std::find_if(peers_.begin(), peers_.end(), [&](const Peer& peer) { return peer.role == role; });
}

const SessionProcess::Peer* SessionProcess::quietest() const {
    return &*std::min_element(peers_.begin(), peers_.end(), [](const Peer& a, const Peer& b) {
        return a.flow.last_accepted() < b.flow.last_accepted();
    });
}

// The node that prevents a start: a dead one, else the first that has not obeyed, else the first that has given up.
const SessionProcess::Peer& SessionProcess::laggard(SessionTime now) const {
    const Peer& quiet = *quietest();
    if (quiet.flow.silent_for(now, kPeerTimeout)) return quiet;
    const auto first = [&](auto stuck) {
        return std::find_if(peers_.begin(), peers_.end(), [&](const Peer& peer) {
            const bool its_turn = peer.role != Role::kMaster || stage_ == Stage::kStartingMaster;
            return its_turn && stuck(peer);
        });
    };
    auto found = first([&](const Peer& peer) { return peer.trial != trial_; });
    if (found == peers_.end()) {
        found = first([](const Peer& peer) { return peer.last.state != NodeState::kRunning; });
    }
    return found == peers_.end() ? quiet : *found;
}

// The others start before the master, so that its first sample finds everybody ready.
void SessionProcess::advance(SessionTime now) {
    switch (stage_) {
        case Stage::kStartingOthers:
            if (all(NodeState::kRunning, false)) enter(now, Stage::kStartingMaster);
            break;
        case Stage::kStartingMaster:
            if (!all(NodeState::kRunning, true)) break;
            record_flow_.expect_from(now + settings_.network_delay);
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
    const bool starting = stage_ == Stage::kStartingOthers || stage_ == Stage::kStartingMaster;
    if (starting && now - stage_since_ > settings_.peer_wait)
        end(now, EndReason::kPeerLost, laggard(now).role);
}

// A heartbeat says that a device has failed, or that the node has been stopped, the datagram behind it why; if that is lost, the next one comes in 100 ms.
bool SessionProcess::end_with_fault(SessionTime now) {
    for (const Peer& peer : peers_) {
        const bool failed = peer.last.state == NodeState::kFailed && has_words(peer.last.reason);
        if (peer.trial != trial_ || !failed || !peer.fault) continue;
        record_.fault = peer.fault->words();
        end(now, peer.last.reason, peer.role);
        return true;
    }
    return false;
}

void SessionProcess::watch(SessionTime now) {
    if (end_with_fault(now)) return;
    const Peer& quiet = *quietest();
    if (quiet.flow.silent_for(now, kPeerTimeout)) return end(now, EndReason::kPeerLost, quiet.role);
    for (const Peer& peer : peers_) {
        if (peer.trial != trial_) continue;
        if (peer.last.state == NodeState::kFailed && !has_words(peer.last.reason)) {
            const bool silent = quiet.flow.silent_for(now, kSuspicious);
            return end(now, EndReason::kPeerLost, silent ? quiet.role : peer.role);
        }
        if (peer.last.state == NodeState::kFinished) return end(now, EndReason::kCompleted);
    }
    if (settings_.ends_by_withdrawal && withdrawn_) return end(now, EndReason::kCompleted);
    // A record with a hole in it is no record of this trial.
    if (record_flow_.lost_for(now, kPeerTimeout)) return end(now, EndReason::kPeerLost, Role::kSlaveSim);
    if (now - stage_since_ > settings_.trial_timeout) end(now, EndReason::kTimeout);
}

void SessionProcess::enter(SessionTime now, Stage stage) {
    stage_ = stage;
    stage_since_ = now;
    next_send_ = now;
}

void SessionProcess::end(SessionTime now, EndReason reason, Role lost_peer) {
    record_.reason = reason;
    record_.lost_peer = lost_peer;
    order_.kind = ControlKind::kTrialEnd;
    order_.reason = reason;
    enter(now, Stage::kEnding);
    send_orders(now);  // at least once: a silent node may still hear it
}

void SessionProcess::finish() {
    stage_ = Stage::kDone;
    const Peer& master = peer(Role::kMaster);
    if (master.trial != trial_ || master.last.state == NodeState::kRunning) return;
    record_.round_trip_s = master.last.round_trip_median_s;
    record_.achieved_delay_s = master.last.round_trip_median_s - master.last.hold_median_s;
}

void SessionProcess::send_orders(SessionTime now) {
    const bool starting = stage_ == Stage::kStartingOthers || stage_ == Stage::kStartingMaster;
    next_send_ = now + (starting || stage_ == Stage::kEnding ? kResend : kHeartbeatPeriod);
    const bool tells = network_changed_ && !starting && stage_ != Stage::kEnding;
    if (tells && std::exchange(network_fresh_, false))
        record_flow_.excuse_silence_until(now + from_seconds(network_order().silence_s));
    for (Peer& peer : peers_) {
        const bool its_turn = stage_ == Stage::kEnding || stage_ == Stage::kStartingMaster ||
                              (stage_ == Stage::kStartingOthers && peer.role != Role::kMaster);
        if (its_turn) {
            peer.told = peer.told || starting;
            peer.out.send(now, trial_, order_);
        } else if (stage_ == Stage::kRunning && fixture_changed_ && peer.role == Role::kSlaveSim) {
            SessionControl change = order_;
            change.kind = ControlKind::kFixtureChange;
            peer.out.send(now, trial_, change);
        } else {
            peer.out.send(now, trial_, Heartbeat{});
        }
        if (tells) peer.out.send(now, trial_, network_order());
        const bool between = stage_ == Stage::kIdle || stage_ == Stage::kDone;
        if (page_ && between && peer.role == Role::kVisual) peer.out.send(now, trial_, *page_);
        // Behind an order, never alone: so a probe wakes no idle node.
        if (peer.prober.due(now)) peer.out.send(now, trial_, peer.prober.probe(now));
    }
}

}  // namespace thimble
