#include "netem/shell/ip_packet.hpp"

#include <optional>

#include "netem/link_model.hpp"

namespace thimble {
namespace {

constexpr std::size_t kHeader4 = 20, kHeader6 = 40;
constexpr std::uint8_t kHopByHop = 0, kIgmp = 2, kTcp = 6, kIcmp6 = 58;

std::size_t read_u16(Bytes bytes, std::size_t at) { return std::size_t{bytes[at]} << 8 | bytes[at + 1]; }

IpPacket read_ip4(Bytes frame) {
    if (frame.size() < kHeader4) return {};
    const std::size_t header = std::size_t{4} * (frame[0] & 0x0FU);
    const std::size_t whole = read_u16(frame, 2);
    if (header < kHeader4 || whole < header || whole > frame.size()) return {};
    const IpKind kind = frame[9] == kIgmp ? IpKind::kLocal : IpKind::kData;
    return {kind, false, frame.first(whole), frame.subspan(16, 4), frame[1], frame[9] == kTcp};
}

// Multicast listener (130 to 132, 143), router and neighbour discovery and redirects (133 to 137).
bool is_local_icmp6(std::uint8_t type) { return (type >= 130 && type <= 137) || type == 143; }

// The type of the ICMPv6 message, also behind hop-by-hop options, which MLD has.
std::optional<std::uint8_t> icmp6_type(Bytes packet) {
    std::uint8_t next = packet[6];
    std::size_t at = kHeader6;
    if (next == kHopByHop && packet.size() >= at + 8) {
        next = packet[at];
        at += 8 * (std::size_t{packet[at + 1]} + 1);
    }
    if (next != kIcmp6 || at >= packet.size()) return std::nullopt;
    return packet[at];
}

IpPacket read_ip6(Bytes frame) {
    if (frame.size() < kHeader6) return {};
    const std::size_t whole = kHeader6 + read_u16(frame, 4);
    if (whole > frame.size()) return {};
    const Bytes packet = frame.first(whole);
    const auto type = icmp6_type(packet);
    const IpKind kind = type && is_local_icmp6(*type) ? IpKind::kLocal : IpKind::kData;
    const auto traffic_class = static_cast<std::uint8_t>(read_u16(packet, 0) >> 4);
    return {kind, true, packet, packet.subspan(24, 16), traffic_class, packet[6] == kTcp};
}

}  // namespace

void mark_congestion(std::span<std::uint8_t> packet) {
    if (packet[0] >> 4 == 6) {
        packet[1] |= kCongestionExperienced << 4;
        return;
    }
    const std::size_t before = read_u16(packet, 0);
    packet[1] |= kCongestionExperienced;
    std::size_t sum = (~read_u16(packet, 10) & 0xFFFF) + (~before & 0xFFFF) + read_u16(packet, 0);
    while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
    packet[10] = static_cast<std::uint8_t>(~sum >> 8);
    packet[11] = static_cast<std::uint8_t>(~sum);
}

IpPacket read_ip_packet(Bytes frame) {
    if (frame.empty()) return {};
    switch (frame[0] >> 4) {
        case 4:
            return read_ip4(frame);
        case 6:
            return read_ip6(frame);
        default:
            return {};
    }
}

}  // namespace thimble
