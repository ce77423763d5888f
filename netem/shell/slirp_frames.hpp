// The Ethernet frames that slirp4netns exchanges over its BESS socket. The program's namespace has a device without Ethernet, so
// this file adds and takes away its header, and tells slirp4netns once where the program's addresses are.
#pragma once

#include "common/channel.hpp"

namespace thimble {

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
