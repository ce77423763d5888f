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
    bool tcp = false;
};

// Never throws; the spans point into `frame`.
IpPacket read_ip_packet(Bytes frame);

// "Congestion experienced" in the header of a packet that read_ip_packet() knows. The checksum of IPv4 follows (RFC 1624).
void mark_congestion(std::span<std::uint8_t> packet);

// The Ethernet frames that slirp4netns exchanges over its BESS socket. The program's namespace has a device without Ethernet, so
// this file adds and takes away its header, and tells slirp4netns once where the program's addresses are.
inline constexpr std::size_t kEthernetBytes = 14;

// slirp4netns' own choice of addresses (slirp4netns(1)).
inline constexpr const char *kSlirpOwn4 = "10.0.2.100", *kSlirpHost4 = "10.0.2.2", *kSlirpDns4 = "10.0.2.3";
inline constexpr const char *kSlirpOwn6 = "fd00::100", *kSlirpHost6 = "fd00::2";

// The IP packet in a frame; empty if it holds something else.
Bytes ip_of_frame(Bytes frame);
// False: the kernel did not take it.
bool send_frame(int socket, Bytes ip_packet);
// An ARP request and a neighbour advertisement, from which slirp4netns learns the program's two addresses.
void announce_addresses(int socket);

}  // namespace thimble
