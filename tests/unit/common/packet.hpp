// Bytes on their way, and the port that they come to.
#pragma once

#include <cstdint>
#include <memory>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include "common/channel.hpp"
#include "common/error.hpp"
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

// A block of UDP ports, kept by a socket on its last one as tests/loopback/workbench.cpp keeps its own.
class GuardedPorts {
  public:
    GuardedPorts() {
        for (unsigned i = 0; i < 150 && !guard_; ++i) {
            base_ = static_cast<std::uint16_t>(10000 + (static_cast<unsigned>(getpid()) + i) % 150 * 128);
            const Endpoint last{"127.0.0.1", static_cast<std::uint16_t>(base_ + 127)};
            try {
                guard_ = std::make_unique<UdpChannel>(last, Endpoint{"127.0.0.1", 0});
            } catch (const Error&) {
                continue;  // another test has this block
            }
        }
    }
    std::uint16_t base() const { return base_; }

  private:
    std::uint16_t base_ = 0;
    std::unique_ptr<UdpChannel> guard_;
};

}  // namespace thimble
