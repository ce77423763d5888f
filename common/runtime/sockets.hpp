// The UDP channels of one program, by the names of network_settings.hpp.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {

class Sockets {
  public:
    explicit Sockets(NetworkSettings settings) : settings_(std::move(settings)) {}

    // Both ways between two known ports (control channels).
    // Arrivals are stamped: clocks are compared here.
    Channel* between(Port local, Port remote);
    // Listens at `local` to the host of `sender` only.
    Channel* inlet(Port local, Role sender) { return open(settings_.at(local), {settings_.host(sender), 0}); }
    // Sends to `remote`, listens to nobody.
    Channel* outlet(Port remote) { return open(std::nullopt, settings_.at(remote)); }

    // Listens at `local` to every host of the session.
    Channel* inlet_for_all(Port local);
    // To the stop lines of all programs of the session.
    std::array<Channel*, kStopPorts.size()> stop_outlets();
    // To and from a device that is not of the session.
    Channel* device(const Endpoint& local, const Endpoint& remote) { return open(local, remote); }
    // Something else that wakes the program; outlives its loop.
    void listen_to(Listener& listener) { listeners_.push_back(&listener); }

    const NetworkSettings& settings() const { return settings_; }
    // The channels that listen, and whatever else does.
    const std::vector<Listener*>& listeners() const { return listeners_; }
    UdpCounters counters() const;

  private:
    UdpChannel* open(const std::optional<Endpoint>& local, const Endpoint& remote);

    NetworkSettings settings_;
    std::vector<std::unique_ptr<UdpChannel>> channels_;
    std::vector<Listener*> listeners_;
};

}  // namespace thimble
