// A UDP socket of a link test: connected to one port of the far side, fragmentation forbidden, each arrival stamped by the
// kernel, and ICMP's complaints read instead of lost.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "common/channel.hpp"
#include "common/runtime/stamp_clock.hpp"
#include "netem/relay/udp_socket.hpp"
#include "thimble/link_test/port_finding.hpp"

namespace thimble {

// Session time of a kernel stamp: never before the arrival, at most a few microseconds after it.
class ArrivalClock {
  public:
    SessionTime arrival(std::int64_t stamp_realtime_ns);

  private:
    StampClock clock_;
};

// IP_PMTUDISC_PROBE: the don't-fragment bit is set, and what the kernel believes about the path is not asked.
void forbid_fragments(const UdpSocket& socket);

class ProbeSocket {
  public:
    // Throws Error (network) if there is no such route at all.
    explicit ProbeSocket(const UdpAddress& remote);

    int descriptor() const { return socket_.descriptor(); }
    // 0 or errno.
    int send(Bytes datagram);

    struct Received {
        Bytes bytes;  // valid until the next call
        SessionTime arrived;
    };
    std::optional<Received> receive();
    // Complaints since the last call go into `evidence`.
    void take_errors(PortEvidence& evidence);

  private:
    UdpSocket socket_;
    ArrivalClock clock_;
    std::unique_ptr<std::uint8_t[]> buffer_;
};

}  // namespace thimble
