#include "session/virtual/queue_network.hpp"

#include <span>
#include <utility>

#include "common/random.hpp"

namespace thimble {
namespace {

constexpr std::size_t kNothingArrives = 2;  // the least capacity

std::unique_ptr<Security> protect(const std::shared_ptr<const LabKey>& lab, std::size_t role) {
    if (!lab) return nullptr;
    auto stream = std::make_shared<RandomStream>(
        StreamKey{1, 0, 0, static_cast<std::uint32_t>(role), Purpose::kInstance});
    return std::make_unique<Security>(lab, [stream](std::span<std::uint8_t> bytes) {
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((*stream)());
    });
}

}  // namespace

QueueNetwork::QueueNetwork(const std::shared_ptr<const LabKey>& lab, MakeTap make_tap)
    : make_tap_(std::move(make_tap)) {
    for (std::size_t role = 0; role < programs_.size(); ++role) {
        programs_[role].network = this;
        programs_[role].self = static_cast<Role>(role);
        security_[role] = protect(lab, role);
    }
}

Channel& QueueNetwork::tapped(Port to, Channel& end) {
    auto tap = make_tap_ ? make_tap_(to, end) : nullptr;
    return tap ? *taps_.emplace_back(std::move(tap)) : end;
}

Channel* QueueNetwork::between(Role self, Port local, Port remote) {
    at(local).connect(at(remote));
    Channel& end = tapped(remote, at(local));
    return security(self) ? security(self)->pair(end, local, remote) : &end;
}

Channel* QueueNetwork::inlet(Role self, Port local) {
    if (security(self) == nullptr) return &at(local);
    return flow(local).from_all ? security(self)->stop_end(at(local), 0, StopEnd::kListens)
                                : security(self)->inlet(at(local), local);
}

Channel* QueueNetwork::outlet(Role self, Port remote) {
    senders_.emplace_back(kNothingArrives).connect(at(remote));
    Channel& end = tapped(remote, senders_.back());
    if (security(self) == nullptr) return &end;
    return flow(remote).from_all ? security(self)->stop_end(end, 0, StopEnd::kSpeaks)
                                 : security(self)->outlet(end, remote);
}

void QueueNetwork::wake(Role role, std::uint32_t* mask, std::uint32_t bit) {
    for (const Port port : kEveryPort) {
        if (owner(port) == role) at(port).wake(mask, bit);
    }
}

SecurityCounters QueueNetwork::counters() const {
    SecurityCounters sum;
    for (const auto& one : security_) {
        if (one) sum.add(one->counters());
    }
    return sum;
}

}  // namespace thimble
