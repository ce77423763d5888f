// Two links between the device of a program's namespace and its other end: another namespace, this machine, or slirp4netns.
//
//   inner device --> link up --> outer port
//   inner device <-- link down <-- outer ports
//
// One link for each direction: all packets of a direction count from 0, whatever their addresses and protocols are.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/runtime/event_waiter.hpp"
#include "netem/link_model.hpp"
#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_totals.hpp"
#include "netem/relay/send_lead.hpp"
#include "netem/relay/steered_relay.hpp"
#include "netem/shell/device_stamps.hpp"
#include "netem/shell/ip_packet.hpp"

namespace thimble {

struct PacketPort {
    int descriptor = -1;    // non-blocking; one packet per read and write
    int stamps = -1;        // open_stamp_socket() of the device, or none
    bool ethernet = false;  // slirp4netns: an Ethernet header stands before each packet
    std::vector<std::uint8_t> host4{},
        host6{};  // what goes to these addresses goes here; the rest to the last port
};

struct PacketRelaySettings {
    LinkPair links{};
    TimelinePair timelines{};
    std::uint64_t seed = 1;
    bool precise = false;
    PacketPort inner;
    std::vector<PacketPort> outer;
};

// Packets that no link has seen.
struct PortTotals {
    std::uint64_t garbage = 0;       // no IP packets
    std::uint64_t local = 0;         // IpKind::kLocal
    std::uint64_t ports_closed = 0;  // ends that are gone: a namespace without processes, slirp4netns
};

// Of the packets of one direction, from being received to being due. `queue` is the time beyond rate and delay: waiting for other
// packets (queue, slots, order) and jitter.
struct StageTotals {
    Histogram queue{};
    Duration rate_sum{};  // time to send
    double rate_mean_us() const {
        return queue.count() == 0 ? 0 : 1e6 * to_seconds(rate_sum) / static_cast<double>(queue.count());
    }
};

// Where our own lateness is from.
struct SendingTotals {
    Histogram
        waking{};  // from the moment to begin at to being awake; packets that found us awake do not count
    Histogram handling{};  // from being awake to the call that sends
    Histogram writing{};   // that call, with the receiver's part of the kernel
};

class PacketRelay final : public SteeredRelay {
  public:
    // `log` may be null and must outlive the relay. `wake`: a descriptor that ends a step when it is readable; -1: none.
    // Throws Error (run failed).
    PacketRelay(const PacketRelaySettings& settings, PacketSink* log, int wake);
    ~PacketRelay() override;

    // One wait, not beyond `latest`, and what follows from it. False: neither a packet nor `wake` was waiting.
    bool step(SessionTime latest);
    void change(SessionTime now, const LinkPair& links) override;
    RelayState state(SessionTime now) const override;
    SessionTime start() const { return start_; }
    const PortTotals& ports() const { return port_totals_; }
    // When the last packet of TCP was read; SessionTime{}: none.
    SessionTime tcp_read() const { return tcp_read_; }
    bool empty() const { return links_[0].in_flight() + links_[1].in_flight() == 0; }
    const StageTotals& stages(RelayDirection direction) const {
        return stages_[static_cast<std::size_t>(direction)];
    }
    const SendingTotals& sending() const { return sending_; }
    const EventWaiter& waiter() const { return waiter_; }

  private:
    void send_due(SessionTime now);
    bool send_turn(std::size_t direction, SessionTime now);
    void send(std::size_t direction, const Departure& departure);
    const PacketPort& port_for(std::size_t direction, Bytes packet) const;
    void receive(std::size_t port);
    bool read_one(std::size_t port, DeviceStamps& stamps);
    void push(std::size_t direction, const IpPacket& packet, SessionTime received);
    Bytes packet_of(const Departure& departure);
    void close_port(std::size_t port);
    void note_stages(std::size_t direction, const Departure& departure);
    void record_sent(std::size_t direction, const Departure& departure, SessionTime sent, bool accepted);
    SessionTime next_due() const { return std::min(links_[0].next_due(), links_[1].next_due()); }
    // The shortest time from waking to the end of the call that sends, less half a microsecond: no program has a packet early.
    Duration send_lead() const {
        constexpr Duration kReadings =
            std::chrono::nanoseconds{500};  // for what readings of clocks are worth
        return handling_.least() + std::max(Duration{}, writing_.least() - kReadings);
    }

    PacketRelaySettings settings_;
    PacketSink* log_;
    EventWaiter waiter_;
    SessionTime start_;
    std::array<LinkModel, 2> links_;                     // RelayDirection
    std::vector<PacketPort> ports_;                      // the inner one, then the outer ones
    std::vector<std::unique_ptr<DeviceStamps>> stamps_;  // of each port
    std::array<std::optional<DropLog>, 2> drops_;
    std::array<SessionTime, 2> last_received_{};
    SessionTime tcp_read_{};
    LeastLately handling_, writing_;    // from waking to the call that sends; that call
    SessionTime woken_ = kNever;        // by a due time, until the first packet has been sent
    std::vector<std::uint8_t> marked_;  // the last packet that a link has marked
    RelayTotals totals_;
    PortTotals port_totals_;
    std::array<StageTotals, 2> stages_{};
    SendingTotals sending_;
};

}  // namespace thimble
