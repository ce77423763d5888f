// Hears all datagrams to one UDP port over loopback, as an attacker on the wire does.
#pragma once

#include <cstdint>
#include <vector>

namespace thimble {

class PacketSniffer {
  public:
    // Not what comes from `own_port`. Throws Error (network) where this user may not listen (CAP_NET_RAW).
    PacketSniffer(std::uint16_t port, std::uint16_t own_port);
    ~PacketSniffer();
    PacketSniffer(const PacketSniffer&) = delete;
    PacketSniffer& operator=(const PacketSniffer&) = delete;

    // The newest datagram since the last call; empty if there was none. Never waits.
    const std::vector<std::uint8_t>& newest();

  private:
    int socket_ = -1;
    std::vector<std::uint8_t> buffer_, datagram_;
};

}  // namespace thimble
