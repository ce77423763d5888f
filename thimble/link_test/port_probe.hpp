// One port of the far side, as the near side of a link test sees it, and the sockets of both sides.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/channel.hpp"
#include "common/histogram.hpp"
#include "common/runtime/stamp_clock.hpp"
#include "common/runtime/udp_socket.hpp"
#include "thimble/link_test/echo_responder.hpp"
#include "thimble/link_test/link_figures.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {

// IP_PMTUDISC_PROBE: the don't-fragment bit is set, and what the kernel believes about the path is not asked.
void forbid_fragments(const UdpSocket& socket);

// The socket is connected, forbids fragmentation, stamps arrivals by the kernel and reads ICMP errors.
class PortProbe {
  public:
    // `asker` tells this test from others of this host. Throws Error (network) if there is no such route at all.
    PortProbe(const PortTraffic& traffic, const UdpAddress& remote, std::uint64_t asker);

    int descriptor() const { return socket_.descriptor(); }
    const PortTraffic& traffic() const { return traffic_; }

    // All that waits; exchanges of stamps are added to `exchanges` as long as there is room reserved.
    void take_all(std::vector<ClockExchange>& exchanges);

    void say_hello(SessionTime now);
    // The port has answered, or has given two errors.
    bool concluded() const { return answers() || complaints_ > 1; }
    bool answers() const { return evidence_.welcomes > 0; }

    // Asks how much has come, with a datagram of `bytes`. 0 or errno.
    int query(SessionTime now, std::size_t bytes);
    // The newest query has been answered, by a datagram of its size.
    bool query_answered() const { return query_.answered; }
    // A query of a session's size behind the newest one. Where its answer alone comes, the other has been lost.
    void follow(SessionTime now);
    bool follower_answered() const { return follower_.answered; }

    void start(SessionTime now);
    SessionTime next_due() const { return next_due_; }
    // Sends what is due; returns how often this machine was too late by so much that probes were left out.
    std::uint32_t send_due(SessionTime now);
    void finish(SessionTime now);
    bool counted() const { return counted_; }
    Duration median_round_trip() const { return round_trip_.quantile(0.5); }

    PortFigures figures() const;

  private:
    struct Query {
        std::uint32_t sequence = 0;
        std::size_t bytes = 0;
        bool answered = false;
        bool is(const ProbePacket& packet, std::size_t size) const {
            return packet.sequence == sequence && size == bytes;
        }
    };
    struct Received {
        Bytes bytes;  // valid until the next call
        SessionTime arrived;
    };
    std::optional<Received> receive();
    // Complaints since the last call go into evidence_.
    void take_errors();
    // 0 or errno.
    int send(ProbeKind kind, SessionTime now, std::uint32_t sequence, std::size_t bytes);
    int ask(Query& query, SessionTime now, std::size_t bytes);
    void take(const ProbePacket& packet, std::size_t bytes, SessionTime arrived,
              std::vector<ClockExchange>& exchanges);
    void take_echo(const ProbePacket& echo, SessionTime arrived, std::vector<ClockExchange>& exchanges);
    void take_counts(const ProbePacket& packet);

    PortTraffic traffic_;
    UdpSocket socket_;
    ArrivalClock clock_;
    std::vector<std::uint8_t> incoming_;
    std::uint64_t asker_, nonce_ = 0;
    PortEvidence evidence_;
    int complaints_ = 0;
    std::vector<std::uint8_t> room_;
    std::uint32_t queries_ = 0;
    Query query_, follower_;
    Duration period_{};
    SessionTime started_{}, ended_{}, next_due_ = kNever, last_echo_{};
    PortFigures figures_;
    ArrivalCounter echoes_;
    Histogram round_trip_;
    Duration longest_gap_{};
    bool counting_ = false, counted_ = false;
};

}  // namespace thimble
