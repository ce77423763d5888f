// The five nodes as the session hears them over their control channels: newest heartbeat, clock, why one has failed.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "common/flow.hpp"
#include "session/clocks/clock_prober.hpp"
#include "session/launch/node_kinds.hpp"

namespace thimble {

class NodePeer {
  public:
    NodePeer(Role role, std::uint64_t instance, Channel& channel)
        : role_(role), in_(role), out_(Role::kSession, instance, {&channel}), channel_(&channel) {}

    Role role() const { return role_; }
    const Heartbeat& newest() const { return newest_; }
    std::uint32_t trial() const { return trial_; }  // of the newest heartbeat
    const ClockProber& prober() const { return prober_; }
    const FlowCounters& counters() const { return in_.counters(); }
    SessionTime last_heard() const { return in_.last_accepted(); }
    bool silent_for(SessionTime now, Duration limit) const { return in_.silent_for(now, limit); }

    // The next message that waits, null if there is none. take() keeps heartbeats and faults. False: it is another kind.
    const Message* receive(SessionTime now) { return in_.receive(now, *channel_); }
    bool take(const Message& message);
    std::optional<ClockExchange> take(SessionTime now, const Header& header, const ClockReply& reply);
    void refuse(Refusal refusal) { in_.refuse_admitted(refusal); }

    template <class Body>
    void send(SessionTime now, std::uint32_t trial, const Body& body) {
        out_.send(now, trial, body);
    }
    void send_probe_if_due(SessionTime now, std::uint32_t trial);

    void forget_trial();
    void tell() { told_ = true; }  // to begin this trial
    bool told() const { return told_; }
    // Its device has failed or it has been stopped in this trial, and its words have arrived; else null.
    const DeviceFault* fault(std::uint32_t trial) const;
    // It has given up this trial for another reason, which is that a peer of it is silent.
    bool misses_peer(std::uint32_t trial) const;

  private:
    Role role_;
    InboundFlow in_;
    OutboundFlow out_;
    Channel* channel_;
    Heartbeat newest_;
    std::uint32_t trial_ = 0;
    std::optional<DeviceFault> fault_;
    bool told_ = false;
    ClockProber prober_;
};

// In the order of kNodeRoles.
class NodePeers {
  public:
    NodePeers(std::uint64_t instance, const std::array<Channel*, kNodes.size()>& channels);

    auto begin() { return peers_.begin(); }
    auto end() { return peers_.end(); }
    auto begin() const { return peers_.begin(); }
    auto end() const { return peers_.end(); }
    const NodePeer& of(Role role) const;

    // The greatest trial number that a node has reported.
    std::uint32_t last_number() const;
    // Roles that have not been heard within `limit`, as text; empty if all are there.
    std::string missing(SessionTime now, Duration limit) const;
    bool all_run(std::uint32_t trial, bool with_master) const;
    const NodePeer& quietest() const;
    // The node that prevents a start: a dead one, else the first that has not obeyed, else the first that has given up.
    const NodePeer& laggard(SessionTime now, std::uint32_t trial, bool with_master) const;

  private:
    std::deque<NodePeer> peers_;
};

}  // namespace thimble
