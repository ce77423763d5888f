// Sends numbered datagrams into one network namespace and takes them out of another, with the receiving kernel's stamps:
// one program and one clock at both ends.
#pragma once

#include <string>

#include "common/runtime/udp_socket.hpp"
#include "tests/kernel/path_sample.hpp"

namespace thimble {

struct PathTraffic {
    std::string sender_namespace, receiver_namespace;  // names below /run/netns, as `ip netns add` makes them
    UdpAddress to;                                     // as the sender sees the network's entrance
    UdpAddress listen;                                 // the receiver's own
    std::size_t packets = 0;
    Duration period = std::chrono::milliseconds{1};
    Duration drain = std::chrono::milliseconds{500};  // how long to wait after the last was sent
};

// Before the first that counts, some are sent that do not, a `drain` ahead: neighbours are known then (ARP). Needs root.
// Throws Error (network) if a namespace cannot be entered or a socket not made.
PathSample run_path_traffic(const PathTraffic& traffic);

}  // namespace thimble
