// A TUN device: what the kernel routes to it, this program reads, one IP packet at a time, and the other way round. Devices are
// made in the network namespace of the calling thread, and vanish with their descriptor.
#pragma once

#include <string>
#include <vector>

namespace thimble {

inline constexpr int kTunMtu =
    1500;  // bytes, as on Ethernet: no piece is larger, because the device offers no offloads

// In text; a device has several networks where it leads to several places.
struct TunAddress {
    std::string ip4, ip6;
    int prefix4 = 24, prefix6 = 64;
};

// The descriptor, non-blocking. Empty or "x%d": the kernel chooses the name. Throws Error (network) that names the device file
// and its remedy; -1 if the name is taken.
int open_tun(const std::string& name);

// Addresses, perhaps the default route, and up. Without IPv6 in the kernel: IPv4 alone; returns whether there is IPv6. Throws
// Error (network).
bool configure_tun(const std::string& name, const std::vector<TunAddress>& addresses, bool default_route);

// A line for a user whose system allows no new namespaces: the sysctl to set.
std::string namespace_remedy();

// The loopback device of a new namespace, and what else its programs expect: pings without privileges.
void configure_namespace();

}  // namespace thimble
