// The ports of a session's programs as queues within one program, for virtual time. A sent datagram waits at its port at once
// and wakes the process that listens there. Messages are handed over without bytes, but behind a tap and with a lab key.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/ports.hpp"
#include "common/queue_channel.hpp"
#include "common/random.hpp"
#include "common/security/security.hpp"

namespace thimble {

inline constexpr std::size_t kNothingArrives = 2;  // the least capacity

inline std::unique_ptr<Security> protect(const std::shared_ptr<const LabKey>& lab, std::size_t role) {
    if (!lab) return nullptr;
    auto stream = std::make_shared<RandomStream>(
        StreamKey{1, 0, 0, static_cast<std::uint32_t>(role), Purpose::kInstance});
    return std::make_unique<Security>(lab, [stream](std::span<std::uint8_t> bytes) {
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((*stream)());
    });
}

class QueueNetwork {
  public:
    // Puts a channel of its own before the end that sends to a port; null leaves the end as it is.
    using MakeTap = std::function<std::unique_ptr<Channel>(Port to, Channel& end)>;

    // With a lab key each program protects its channels as between real processes, with random numbers of its own.
    explicit QueueNetwork(const std::shared_ptr<const LabKey>& lab = nullptr, MakeTap make_tap = {})
        : make_tap_(std::move(make_tap)) {
        for (std::size_t role = 0; role < programs_.size(); ++role) {
            programs_[role].network = this;
            programs_[role].self = static_cast<Role>(role);
            security_[role] = protect(lab, role);
        }
        for (QueueChannel& port : arrivals_) port.share(pool_);
    }

    // The ports of one program. The network outlives whatever is opened.
    Ports& of(Role role) { return programs_[static_cast<std::size_t>(role)]; }
    // Protects a program's channels; null without a lab key. A SecuredProcess calls it each tick.
    Security* security(Role role) const { return security_[static_cast<std::size_t>(role)].get(); }
    // of all programs
    SecurityCounters counters() const {
        SecurityCounters sum;
        for (const auto& one : security_) {
            if (one) sum.add(one->counters());
        }
        return sum;
    }

    // Each datagram for this program sets `bit` in `*mask`.
    void wake(Role role, std::uint32_t* mask, std::uint32_t bit) {
        for (const Port port : kEveryPort) {
            if (owner(port) == role) at(port).wake(mask, bit);
        }
    }

  private:
    class Program final : public Ports {
      public:
        Channel* between(Port local, Port remote) override { return network->between(self, local, remote); }
        Channel* inlet(Port local) override { return network->inlet(self, local); }
        Channel* outlet(Port remote) override { return network->outlet(self, remote); }

        QueueNetwork* network = nullptr;
        Role self = Role::kSession;
    };

    Channel* between(Role self, Port local, Port remote) {
        at(local).connect(at(remote));
        Channel& end = tapped(remote, at(local));
        return security(self) ? security(self)->pair(end, local, remote) : &end;
    }

    Channel* inlet(Role self, Port local) {
        if (security(self) == nullptr) return &at(local);
        return flow(local).from_all ? security(self)->stop_end(at(local), 0, StopEnd::kListens)
                                    : security(self)->inlet(at(local), local);
    }

    Channel* outlet(Role self, Port remote) {
        QueueChannel& sender = senders_.emplace_back(kNothingArrives);
        sender.connect(at(remote));
        sender.share(pool_);
        Channel& end = tapped(remote, sender);
        if (security(self) == nullptr) return &end;
        return flow(remote).from_all ? security(self)->stop_end(end, 0, StopEnd::kSpeaks)
                                     : security(self)->outlet(end, remote);
    }

    QueueChannel& at(Port port) { return arrivals_[static_cast<std::size_t>(port)]; }
    Channel& tapped(Port to, Channel& end) {
        auto tap = make_tap_ ? make_tap_(to, end) : nullptr;
        return tap ? *taps_.emplace_back(std::move(tap)) : end;
    }

    MessagePool pool_;
    MakeTap make_tap_;
    std::array<QueueChannel, kPortCount> arrivals_;  // what waits at each port
    std::deque<QueueChannel> senders_;               // of the outlets
    std::vector<std::unique_ptr<Channel>> taps_;
    std::array<std::unique_ptr<Security>, kRoleCount> security_;
    std::array<Program, kRoleCount> programs_;
};

}  // namespace thimble
