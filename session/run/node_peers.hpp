// The five nodes as the session hears them over their control channels: newest heartbeat, clock, why one has failed.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "common/flow.hpp"
#include "common/node_process.hpp"
#include "session/clocks/clock_prober.hpp"
#include "session/launch/node_kinds.hpp"

namespace thimble {

// Reasons whose text follows the heartbeat.
inline bool has_words(EndReason reason) { return reason == EndReason::kDeviceFault || is_stop(reason); }

class NodePeer {
  public:
    NodePeer(Role role, std::uint64_t instance, Channel& channel)
        : role_(role), in_(role), out_(Role::kSession, instance, {&channel}), channel_(&channel) {}

    Role role() const { return role_; }
    const Heartbeat& newest() const { return newest_; }
    std::uint32_t trial() const { return trial_; }  // of the newest heartbeat
    bool known() const { return known_; }           // a heartbeat has come: state and trial are the node's
    const ClockProber& prober() const { return prober_; }
    const FlowCounters& counters() const { return in_.counters(); }
    SessionTime last_heard() const { return in_.last_accepted(); }
    bool silent_for(SessionTime now, Duration limit) const { return in_.silent_for(now, limit); }
    void did_not_listen(Duration time) { in_.did_not_listen(time); }

    // The next message that waits, null if there is none. take() keeps heartbeats and faults. False: it is another kind.
    const Message* receive(SessionTime now) { return in_.receive(now, *channel_); }
    bool take(const Message& message) {
        if (const auto* heartbeat = std::get_if<Heartbeat>(&message.body)) {
            newest_ = *heartbeat;
            trial_ = message.header.trial;
            known_ = true;
            return true;
        }
        const auto* fault = std::get_if<DeviceFault>(&message.body);
        if (fault != nullptr) fault_ = *fault;
        return fault != nullptr;
    }

    std::optional<ClockExchange> take(SessionTime now, const Header& header, const ClockReply& reply) {
        return prober_.take(reply, header.send_time, channel_->arrival().value_or(now));
    }

    void refuse(Refusal refusal) { in_.refuse_admitted(refusal); }

    template <class Body>
    void send(SessionTime now, std::uint32_t trial, const Body& body) {
        out_.send(now, trial, body);
    }
    void send_probe_if_due(SessionTime now, std::uint32_t trial) {
        if (prober_.due(now)) send(now, trial, prober_.probe(now));
    }

    void forget_trial() {
        fault_.reset();
        told_ = false;
    }

    void tell() { told_ = true; }  // to begin this trial
    bool told() const { return told_; }
    // Its device has failed or it has been stopped in this trial, and its words have arrived; else null.
    // The heartbeat says that it has failed, the datagram behind it why; if that is lost, the next one comes in 100 ms.
    const DeviceFault* fault(std::uint32_t trial) const {
        const bool failed = newest_.state == NodeState::kFailed && has_words(newest_.reason);
        return trial_ == trial && failed && fault_ ? &*fault_ : nullptr;
    }

    // It has given up this trial for another reason, which is that a peer of it is silent.
    bool misses_peer(std::uint32_t trial) const {
        return trial_ == trial && newest_.state == NodeState::kFailed && !has_words(newest_.reason);
    }

  private:
    Role role_;
    InboundFlow in_;
    OutboundFlow out_;
    Channel* channel_;
    Heartbeat newest_;
    std::uint32_t trial_ = 0;
    bool known_ = false;
    std::optional<DeviceFault> fault_;
    bool told_ = false;
    ClockProber prober_;
};

// Of a node that is there.
inline constexpr std::string_view kGaveUp = "gave the trial up, because it heard nothing from a program";

// In the order of kNodeRoles.
class NodePeers {
  public:
    NodePeers(std::uint64_t instance, const std::array<Channel*, kNodes.size()>& channels) {
        peers_.reserve(kNodes.size());
        for (std::size_t i = 0; i < kNodes.size(); ++i)
            peers_.emplace_back(kNodes[i].role, instance, *channels[i]);
    }

    auto begin() { return peers_.begin(); }
    auto end() { return peers_.end(); }
    auto begin() const { return peers_.begin(); }
    auto end() const { return peers_.end(); }
    const NodePeer& of(Role role) const {
        return *std::find_if(begin(), end(), [&](const NodePeer& peer) { return peer.role() == role; });
    }

    // The greatest trial number that a node has reported.
    std::uint32_t last_number() const {
        return std::max_element(begin(), end(),
                                [](const NodePeer& a, const NodePeer& b) { return a.trial() < b.trial(); })
            ->trial();
    }

    // Roles that have not been heard within `limit`, as text; empty if all are there.
    std::string missing(SessionTime now, Duration limit) const {
        std::string names;
        for (const NodePeer& peer : peers_) {
            const bool heard = peer.known() && !peer.silent_for(now, limit);
            if (!heard) names += (names.empty() ? "" : ", ") + std::string(to_string(peer.role()));
        }
        return names;
    }

    // How long a lost node has been silent, or what it misses, as text.
    std::string silence(SessionTime now, Role role, std::uint32_t trial) const {
        const NodePeer& peer = of(role);
        if (peer.misses_peer(trial) && !peer.silent_for(now, kPeerTimeout))
            return fmt::format("{} {} that it needs: that one stood still, or its data were lost on the way",
                               to_string(role), kGaveUp);
        if (!peer.known()) return fmt::format("{} has sent no message", to_string(role));
        return fmt::format("the last message from {} came {:.2f} s before", to_string(role),
                           to_seconds(now - peer.last_heard()));
    }

    bool all_run(std::uint32_t trial, bool with_master) const {
        return std::all_of(begin(), end(), [&](const NodePeer& peer) {
            if (peer.role() == Role::kMaster && !with_master) return true;
            return peer.trial() == trial && peer.newest().state == NodeState::kRunning;
        });
    }

    const NodePeer& quietest() const {
        return *std::min_element(begin(), end(), [](const NodePeer& a, const NodePeer& b) {
            return a.last_heard() < b.last_heard();
        });
    }

    // The node that delays a start: a dead one, else the first that has not answered, else the first that has given
    // up.
    const NodePeer& slowest_node(SessionTime now, std::uint32_t trial, bool with_master) const {
        const NodePeer& quiet = quietest();
        if (quiet.silent_for(now, kPeerTimeout)) return quiet;
        const auto first = [&](auto stuck) {
            return std::find_if(begin(), end(), [&](const NodePeer& peer) {
                return (peer.role() != Role::kMaster || with_master) && stuck(peer);
            });
        };
        auto found = first([&](const NodePeer& peer) { return peer.trial() != trial; });
        if (found == end())
            found = first([](const NodePeer& peer) { return peer.newest().state != NodeState::kRunning; });
        return found == end() ? quiet : *found;
    }

  private:
    std::vector<NodePeer> peers_;
};

}  // namespace thimble
