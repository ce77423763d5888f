// Bytes on their way, and the port that they come to.
#pragma once

#include <cstdint>
#include <netinet/in.h>
#include <sys/socket.h>
#include <vector>

#include "common/channel.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {

using Packet = std::vector<std::uint8_t>;

inline Packet copy(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

// Any free port, so that tests can run side by side.
inline std::uint16_t port_of(const UdpChannel& channel) {
    sockaddr_in address{};
    socklen_t length = sizeof address;
    getsockname(channel.file_descriptor(), static_cast<sockaddr*>(static_cast<void*>(&address)), &length);
    return ntohs(address.sin_port);
}

}  // namespace thimble
