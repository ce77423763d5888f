#include "session/run/node_peers.hpp"

#include <algorithm>
#include <variant>

#include "common/node_process.hpp"

namespace thimble {
namespace {

// Reasons whose text follows the heartbeat.
bool has_words(EndReason reason) { return reason == EndReason::kDeviceFault || is_stop(reason); }

}  // namespace

bool NodePeer::take(const Message& message) {
    if (const auto* heartbeat = std::get_if<Heartbeat>(&message.body)) {
        newest_ = *heartbeat;
        trial_ = message.header.trial;
        return true;
    }
    const auto* fault = std::get_if<DeviceFault>(&message.body);
    if (fault != nullptr) fault_ = *fault;
    return fault != nullptr;
}

std::optional<ClockExchange> NodePeer::take(SessionTime now, const Header& header, const ClockReply& reply) {
    return prober_.take(reply, header.send_time, channel_->arrival().value_or(now));
}

void NodePeer::send_probe_if_due(SessionTime now, std::uint32_t trial) {
    if (prober_.due(now)) send(now, trial, prober_.probe(now));
}

void NodePeer::forget_trial() {
    fault_.reset();
    told_ = false;
}

// The heartbeat says that it has failed, the datagram behind it why; if that is lost, the next one comes in 100 ms.
const DeviceFault* NodePeer::fault(std::uint32_t trial) const {
    const bool failed = newest_.state == NodeState::kFailed && has_words(newest_.reason);
    return trial_ == trial && failed && fault_ ? &*fault_ : nullptr;
}

bool NodePeer::misses_peer(std::uint32_t trial) const {
    return trial_ == trial && newest_.state == NodeState::kFailed && !has_words(newest_.reason);
}

NodePeers::NodePeers(std::uint64_t instance, const std::array<Channel*, kNodes.size()>& channels) {
    for (std::size_t i = 0; i < kNodes.size(); ++i)
        peers_.emplace_back(kNodes[i].role, instance, *channels[i]);
}

const NodePeer& NodePeers::of(Role role) const {
    return *std::find_if(begin(), end(), [&](const NodePeer& peer) { return peer.role() == role; });
}

std::uint32_t NodePeers::last_number() const {
    return std::max_element(begin(), end(),
                            [](const NodePeer& a, const NodePeer& b) { return a.trial() < b.trial(); })
        ->trial();
}

std::string NodePeers::missing(SessionTime now, Duration limit) const {
    std::string names;
    for (const NodePeer& peer : peers_) {
        const bool heard = peer.counters().accepted > 0 && !peer.silent_for(now, limit);
        if (!heard) names += (names.empty() ? "" : ", ") + std::string(to_string(peer.role()));
    }
    return names;
}

bool NodePeers::all_run(std::uint32_t trial, bool with_master) const {
    return std::all_of(begin(), end(), [&](const NodePeer& peer) {
        if (peer.role() == Role::kMaster && !with_master) return true;
        return peer.trial() == trial && peer.newest().state == NodeState::kRunning;
    });
}

const NodePeer& NodePeers::quietest() const {
    return *std::min_element(
        begin(), end(), [](const NodePeer& a, const NodePeer& b) { return a.last_heard() < b.last_heard(); });
}

const NodePeer& NodePeers::laggard(SessionTime now, std::uint32_t trial, bool with_master) const {
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

}  // namespace thimble
