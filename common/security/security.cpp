#include "common/security/security.hpp"

#include <algorithm>
#include <stdexcept>

namespace thimble {
namespace {

// Views have no flows but their own two-way channel.
bool is_node_end(Port port) { return port >= Port::kMasterControl && port <= Port::kNetemControl; }

}  // namespace

Security::Security(std::shared_ptr<const LabKey> lab, RandomBytes random, const SecurityTimes& times)
    : lab_(std::move(lab)), random_(std::move(random)), times_(times) {}

Channel* Security::pair(Channel& wire, Port local, Port remote) {
    self_ = owner(local);
    pairs_.push_back(
        std::make_unique<SecurePair>(wire, *lab_, SecurePair::Ends{local, remote}, random_, times_));
    SecurePair& added = *pairs_.back();
    if (is_node_end(local)) ring_ = std::make_unique<KeyRing>(ends_, added, times_);
    if (is_node_end(remote)) {
        if (!server_) server_ = std::make_unique<KeyServer>(ends_, random_, times_);
        server_->serve(added);
    }
    return &added;
}

Channel* Security::inlet(Channel& wire, Port local) {
    self_ = owner(local);
    Channel* end = &wire;
    if (ends_hop(local)) end = add_inlet(*end, {local, true});
    return self_ == Role::kNetem ? end : add_inlet(*end, {local, false});
}

Channel* Security::add_inlet(Channel& wire, const KeyedFlow& keyed) {
    inlets_.push_back(std::make_unique<SecureInlet>(wire, keyed));
    ends_.inlets.push_back(inlets_.back().get());
    return inlets_.back().get();
}

Channel* Security::outlet(Channel& wire, Port remote) {
    if (!self_) throw std::logic_error("an outlet of nobody: open a channel that listens first");
    Channel* end = &wire;
    if (ends_hop(remote)) end = add_outlet(*end, {remote, true});
    return self_ == Role::kNetem ? end : add_outlet(*end, {final_port(remote), false});
}

Channel* Security::add_outlet(Channel& wire, const KeyedFlow& keyed) {
    outlets_.push_back(std::make_unique<SecureOutlet>(wire, keyed));
    ends_.outlets.push_back(outlets_.back().get());
    return outlets_.back().get();
}

Channel* Security::stop_end(Channel& wire, std::uint16_t port, StopEnd end) {
    stop_ends_.push_back(std::make_unique<StopSeal>(wire, lab_, port, end));
    return stop_ends_.back().get();
}

void Security::tick(SessionTime now) {
    ticks_.tick(now);
    if (ring_) ring_->tick(now);
    for (const auto& one : pairs_) {
        one->did_not_listen(ticks_.stood_still());
        one->tick(now);
    }
    if (server_) server_->tick(now);
}

SessionTime Security::next_wakeup() const {
    SessionTime next = server_ ? server_->next_wakeup() : kNever;
    for (const auto& one : pairs_) next = std::min(next, one->next_wakeup());
    return next;
}

bool Security::complete() const {
    if (server_) return server_->complete();
    return std::all_of(pairs_.begin(), pairs_.end(), [](const auto& one) { return one->established(); });
}

SecurityCounters Security::counters() const {
    SecurityCounters sum;
    for (const auto& one : pairs_) sum.add(one->counters());
    // At the ends of a flow a datagram and its hop are one.
    const auto add = [this, &sum](const auto& end) {
        SecurityCounters one = end->counters();
        if (end->keyed().hop && self_ != Role::kNetem) one.sealed = one.opened = 0;
        sum.add(one);
    };
    std::for_each(inlets_.begin(), inlets_.end(), add);
    std::for_each(outlets_.begin(), outlets_.end(), add);
    for (const auto& one : stop_ends_) sum.add(one->counters());
    return sum;
}

std::string Security::complaint() const {
    std::string text;
    if (const std::string names = peers_with(PairTrouble::kWrongLabKey); !names.empty())
        text = "wrong lab key or another rig: " + names +
               " uses another key than this program: give both the same [security] (mode, key_file, rig) and "
               "[network] (hosts, base_port); with mode \"user-key\" start both as the same user "
               "(docs/security.md)";
    if (const std::string names = peers_with(PairTrouble::kUnsealed); !names.empty())
        text += (text.empty() ? "" : "; ") + names +
                " sends without protection: give it the same [security] mode as this program";
    return text;
}

std::string Security::peers_with(PairTrouble trouble) const {
    std::string names;
    for (const auto& one : pairs_) {
        if (one->trouble() == trouble)
            names += (names.empty() ? "" : ", ") + std::string(to_string(one->peer()));
    }
    return names;
}

}  // namespace thimble
