// The channels of one program, by the names of network_settings.hpp: UDP, protected as [security] says.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/ports.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/security/security.hpp"

namespace thimble {

class MessageLog;

// Of one tick, by the port that they are sent to.
using DatagramCounts = std::array<std::uint16_t, kPortCount>;

class Sockets final : public Ports {
  public:
    // Throws Error as require_protection() and make_security() do.
    explicit Sockets(NetworkSettings settings);

    // The log gets all messages of channels opened from now on: of the control channels, or of all but the devices'
    // channels. Before anything is opened; `log` outlives this.
    void record_to(MessageLog& log, bool all) {
        log_ = &log;
        log_all_ = all;
    }

    // In lock-step, before anything is opened: channels give what was announced, and wait for it as udp_channel.hpp says.
    void count_datagrams(Duration limit) { limit_ = limit; }
    // How many datagrams were sent to each port. Those of other programs are passed over.
    void announce(std::span<const std::uint16_t> datagrams);
    // Of a port that this program listens at (UdpChannel::hear_outside).
    bool hear_outside(Port port) { return at_.at(static_cast<std::size_t>(port))->hear_outside(); }
    // Since the last call.
    DatagramCounts take_sent() { return std::exchange(sent_, {}); }

    // Arrivals are stamped, except in lock-step: clocks are compared here.
    Channel* between(Port local, Port remote) override;
    Channel* inlet(Port local) override;
    Channel* outlet(Port remote) override;

    // To and from a device that is not of the session, unprotected. Throws Error (usage) if it is elsewhere and the file does
    // not allow that.
    Channel* device(const Endpoint& local, const Endpoint& remote);
    // Something else that wakes the program; outlives its loop.
    void listen_to(Listener& listener) { listeners_.push_back(&listener); }

    const NetworkSettings& settings() const { return settings_; }
    // The channels that listen, and whatever else does.
    const std::vector<Listener*>& listeners() const { return listeners_; }
    UdpCounters counters() const;

    // Protects the channels; null in mode "none". A SecuredProcess keeps it going.
    Security* security() const { return security_.get(); }
    // For loops that are not a process: before and after receiving and sending.
    void tick(SessionTime now) {
        if (security_) security_->tick(now);
    }

  private:
    UdpChannel* open(const std::optional<Endpoint>& local, const Endpoint& remote);
    void count(UdpChannel& channel, std::optional<Port> local, std::optional<Port> remote);

    Channel* stop_end(Channel& channel, Port port, StopEnd end);
    Channel* log_control(Channel* channel, Port local, Port remote);
    Channel* log_data(Channel* channel, Port port);

    NetworkSettings settings_;
    MessageLog* log_ = nullptr;
    bool log_all_ = false;
    std::vector<std::unique_ptr<UdpChannel>> channels_;
    std::unique_ptr<Security> security_;  // goes before the channels that it uses
    std::vector<Listener*> listeners_;
    Duration limit_{};  // zero: not in lock-step
    DatagramCounts sent_{};
    std::array<UdpChannel*, kPortCount> at_{};  // in lock-step
};

}  // namespace thimble
