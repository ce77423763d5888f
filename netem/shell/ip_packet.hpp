// The header of an IP packet, as far as a link needs it: length, destination, and whether the packet is the program's or is between
// the two kernels alone.
#pragma once

#include <cstdint>
#include <span>

#include "common/channel.hpp"

namespace thimble {

enum class IpKind : std::uint8_t {
    kData,  // the link carries it, and it has a number
    kLocal,  // IGMP, MLD, neighbour and router discovery: kernels send these by their own timers, and two ends need none
    kGarbage,  // no IP packet, or one that is cut
};

struct IpPacket {
    IpKind kind = IpKind::kGarbage;
    bool v6 = false;
    Bytes bytes{};                   // without what may follow the packet in its frame
    Bytes destination{};             // 4 or 16 bytes
    std::uint8_t traffic_class = 0;  // DSCP and ECN bits
};

// Never throws; the spans point into `frame`.
IpPacket read_ip_packet(Bytes frame);

// "Congestion experienced" in the header of a packet that read_ip_packet() knows. The checksum of IPv4 follows (RFC 1624).
void mark_congestion(std::span<std::uint8_t> packet);

}  // namespace thimble
