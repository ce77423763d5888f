// IP packets for tests, without checksums.
#pragma once

#include <cstddef>
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

// An IPv4 packet with the checksum of its header: all 16-bit words add up to 0xFFFF.
inline Octets with_checksum(Octets packet) {
    packet[10] = packet[11] = 0;
    unsigned sum = 0;
    for (std::size_t i = 0; i < 20; i += 2) sum += unsigned{packet[i]} << 8 | packet[i + 1];
    while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
    packet[10] = static_cast<std::uint8_t>(~sum >> 8);
    packet[11] = static_cast<std::uint8_t>(~sum);
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
