// The ports of a session's programs as queues within one program, for virtual time. A sent datagram waits at its port at once
// and wakes the process that listens there.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "common/ports.hpp"
#include "common/queue_channel.hpp"
#include "common/security/security.hpp"

namespace thimble {

class QueueNetwork {
  public:
    // Puts a channel of its own before the end that sends to a port; null leaves the end as it is.
    using MakeTap = std::function<std::unique_ptr<Channel>(Port to, Channel& end)>;

    // With a lab key each program protects its channels as between real processes, with random numbers of its own.
    explicit QueueNetwork(const std::shared_ptr<const LabKey>& lab = nullptr, MakeTap make_tap = {});

    // The ports of one program. The network outlives whatever is opened.
    Ports& of(Role role) { return programs_[static_cast<std::size_t>(role)]; }
    // Protects a program's channels; null without a lab key. A SecuredProcess calls it each tick.
    Security* security(Role role) const { return security_[static_cast<std::size_t>(role)].get(); }
    SecurityCounters counters() const;  // of all programs

    // Each datagram for this program sets `bit` in `*mask`.
    void wake(Role role, std::uint32_t* mask, std::uint32_t bit);

  private:
    class Program final : public Ports {
      public:
        Channel* between(Port local, Port remote) override { return network->between(self, local, remote); }
        Channel* inlet(Port local) override { return network->inlet(self, local); }
        Channel* outlet(Port remote) override { return network->outlet(self, remote); }

        QueueNetwork* network = nullptr;
        Role self = Role::kSession;
    };

    Channel* between(Role self, Port local, Port remote);
    Channel* inlet(Role self, Port local);
    Channel* outlet(Role self, Port remote);
    QueueChannel& at(Port port) { return arrivals_[static_cast<std::size_t>(port)]; }
    Channel& tapped(Port to, Channel& end);

    MakeTap make_tap_;
    std::array<QueueChannel, kPortCount> arrivals_;  // what waits at each port
    std::deque<QueueChannel> senders_;               // of the outlets
    std::vector<std::unique_ptr<Channel>> taps_;
    std::array<std::unique_ptr<Security>, kRoleCount> security_;
    std::array<Program, kRoleCount> programs_;
};

}  // namespace thimble
