// The UDP channels of one program, by the names of network_settings.hpp.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {

class MessageLog;

class Sockets {
  public:
    explicit Sockets(NetworkSettings settings) : settings_(std::move(settings)) {}

    // What passes from now on, through channels opened from now on, is written down there: of the control channels, or of all
    // but those of devices. Before anything is opened; `log` outlives this.
    void record_to(MessageLog& log, bool all) {
        log_ = &log;
        log_all_ = all;
    }

    // Both ways between two known ports (control channels).
    // Arrivals are stamped: clocks are compared here.
    Channel* between(Port local, Port remote);
    // Listens at `local` to the host of `sender` only.
    Channel* inlet(Port local, Role sender) {
        return data(*open(settings_.at(local), {settings_.host(sender), 0}), local);
    }
    // Sends to `remote`, listens to nobody.
    Channel* outlet(Port remote) { return data(*open(std::nullopt, settings_.at(remote)), remote); }

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

    Channel* data(Channel& channel, Port port);

    NetworkSettings settings_;
    MessageLog* log_ = nullptr;
    bool log_all_ = false;
    std::vector<std::unique_ptr<UdpChannel>> channels_;
    std::vector<Listener*> listeners_;
};

}  // namespace thimble
