// IP packets for tests, right but for their checksums.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace thimble {

using Octets = std::vector<std::uint8_t>;

inline Octets ip4_packet(std::uint8_t protocol, std::string_view payload) {
    Octets packet(20, 0);
    packet[0] = 0x45;
    packet[3] = static_cast<std::uint8_t>(20 + payload.size());
    packet[9] = protocol;
    packet[16] = 10;
    packet[19] = 2;
    packet.insert(packet.end(), payload.begin(), payload.end());
    return packet;
}

inline Octets ip6_packet(std::uint8_t next_header, const Octets& payload) {
    Octets packet(40, 0);
    packet[0] = 0x60;
    packet[5] = static_cast<std::uint8_t>(payload.size());
    packet[6] = next_header;
    packet[39] = 2;
    packet.insert(packet.end(), payload.begin(), payload.end());
    return packet;
}

inline constexpr std::uint8_t kUdp = 17;

}  // namespace thimble
