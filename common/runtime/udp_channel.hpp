// Datagrams over UDP (IPv4), never blocking. One socket: bound to a local port, or only sending.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/channel.hpp"
#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/listener.hpp"
#include "common/runtime/stamp_clock.hpp"
#include "common/runtime/udp_socket.hpp"

namespace thimble {

struct UdpCounters {
    std::uint64_t sent = 0, received = 0;
    std::uint64_t send_failed = 0;     // the kernel refused: buffer full, no route, port closed
    std::uint64_t foreign_source = 0;  // from a host that is not the configured peer
    std::uint64_t too_long = 0;        // larger than kMaxDatagramBytes
};

// Whether a host name means the machine that resolves it: 127.0.0.0/8 (on Debian also a machine's own name) or
// 0.0.0.0. False for a name that cannot be resolved here.
bool means_this_machine(const std::string& host);

// Whether datagrams to this host can leave the machine: an address outside 127.0.0.0/8. True for a name that cannot
// be resolved now.
bool leaves_this_machine(const std::string& host);

// In lock-step: an announced datagram has not come.
class DatagramLost : public Error {
  public:
    DatagramLost(Port port, std::string what) : Error(ExitCode::kNetwork, std::move(what)), port_(port) {}
    Port port() const { return port_; }  // where it should have arrived

  private:
    Port port_;
};

class UdpChannel final : public Channel, public Listener {
  public:
    // `local`: where to listen; absent for a channel that only sends. `remote`: where to send, and the only
    // host that is listened to, of one in 127.0.0.0/8 with 127.0.0.1 (in lock-step only for hear_outside()). Throws Error
    // (network) with the address if the port is taken or a name cannot be resolved.
    UdpChannel(const std::optional<Endpoint>& local, const Endpoint& remote);
    void send(Bytes datagram) override;
    void answer(Bytes datagram) override;

    // The peer's address may change: every host is heard. Only for datagrams that are sealed.
    void let_peer_move() { peer_moves_ = true; }
    void send_back(Bytes datagram) override { send_to(peer_moves_ ? source_ : remote_, datagram); }
    void follow() override;

    // From now on the kernel stamps what arrives, and arrival() is known. Costs three clock readings per datagram.
    void stamp_arrivals();
    std::optional<SessionTime> arrival() const override { return arrival_; }

    // Hosts that are listened to besides the remote one. Throws Error (network) if a name cannot be resolved.
    void listen_also_to(const std::vector<std::string>& hosts);

    // To wait on; readable when a datagram is there.
    int file_descriptor() const override { return socket_.descriptor(); }
    // Asking an empty socket is a system call for nothing. Once watched, the channel counts as empty from the moment
    // that nothing was left until the watcher says has_mail().
    void set_watched(bool watched) override {
        watched_ = watched;
        known_empty_ = false;
    }
    void has_mail() override { known_empty_ = false; }
    const UdpCounters& counters() const { return counters_; }

    // In lock-step (lock_step.hpp) nothing is lost and nothing comes by surprise. Each datagram that is sent counts in `sent`, of the
    // flow that arrives at `port`.
    void count_sent(Port port, std::uint16_t& sent);
    // Its datagrams leave from the port of the other channel, which outlives this: so receivers know them for the session's own.
    void send_from(const UdpChannel& other) { out_ = other.out_; }
    // From now on this channel, which listens at `port`, gives the datagrams that were announced and no other. It waits for them,
    // each no longer than `limit`. They come from ports of the session, from `base_port` on; any other is foreign. receive()
    // throws DatagramLost if one is missing, send() throws Error (network).
    void await_announced(Port port, std::uint16_t base_port, Duration limit);
    void announce(std::uint16_t datagrams) {
        announced_ += datagrams;
        known_empty_ = announced_ <= 0;
    }
    // In lock-step: the next calls of receive() also give what programs outside the session have sent. False: nothing waits.
    bool hear_outside();

  private:
    Bytes take() override;
    void bind_to(const Endpoint& local);
    void know(in_addr_t host);
    bool knows(in_addr_t host) const;
    bool of_session() const;
    bool from_peer(std::size_t size);
    void wait_for_announced();
    void send_to(const sockaddr_in& address, Bytes datagram);

    UdpSocket socket_;
    int out_ = -1;  // the socket that sends
    sockaddr_in remote_{};
    sockaddr_in source_{};          // of what was taken last
    std::vector<in_addr_t> known_;  // hosts
    bool known_loopback_ = false;   // one of them is in 127.0.0.0/8
    bool peer_moves_ = false;
    UdpCounters counters_;
    bool stamping_ = false;
    bool watched_ = false;
    std::uint16_t* sent_ = nullptr;  // in lock-step
    Port sent_to_{}, listens_at_{};
    std::uint16_t base_port_ = 0;
    Duration limit_{};   // zero: not in lock-step
    int announced_ = 0;  // below 0: taken before it was announced, by hear_outside()
    bool hears_outside_ = false;
    ArrivalClock arrival_clock_;
    std::optional<SessionTime> arrival_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes + 1> buffer_{};
};

}  // namespace thimble
