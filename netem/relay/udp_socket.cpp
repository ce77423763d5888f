#include "netem/relay/udp_socket.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <linux/sock_diag.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// A burst of some thousand datagrams while this program could not run. Root gets it whatever net.core.rmem_max says.
constexpr int kBufferBytes = 4 << 20;

void enlarge(int descriptor, int forced, int polite) {
    if (setsockopt(descriptor, SOL_SOCKET, forced, &kBufferBytes, sizeof kBufferBytes) != 0) {
        setsockopt(descriptor, SOL_SOCKET, polite, &kBufferBytes, sizeof kBufferBytes);
    }
}

const sockaddr* raw(const sockaddr_in& address) {
    return static_cast<const sockaddr*>(static_cast<const void*>(&address));
}

}  // namespace

UdpSocket UdpSocket::open() {
    UdpSocket made(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (made.descriptor_ < 0) {
        throw Error(ExitCode::kNetwork, fmt::format("cannot open a UDP socket: {}", std::strerror(errno)));
    }
    enlarge(made.descriptor_, SO_RCVBUFFORCE, SO_RCVBUF);
    enlarge(made.descriptor_, SO_SNDBUFFORCE, SO_SNDBUF);
    const int on = 1;
    setsockopt(made.descriptor_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
    return made;
}

UdpSocket UdpSocket::listening(const UdpAddress& local) {
    UdpSocket made = open();
    const sockaddr_in address = local.generic();
    if (bind(made.descriptor_, raw(address), sizeof address) != 0) {
        throw Error(
            ExitCode::kNetwork,
            fmt::format("cannot listen on UDP {}: {}; {}", to_string(local), std::strerror(errno),
                        errno == EADDRINUSE ? "another program has that port: choose another, or stop it"
                                            : "is that an address of this machine?"));
    }
    return made;
}

UdpSocket UdpSocket::connected(const UdpAddress& remote) {
    UdpSocket made = open();
    const sockaddr_in address = remote.generic();
    if (connect(made.descriptor_, raw(address), sizeof address) != 0) {
        throw Error(ExitCode::kNetwork, fmt::format("cannot send to UDP {}: {}; is there a route to it?",
                                                    to_string(remote), std::strerror(errno)));
    }
    return made;
}

UdpSocket::~UdpSocket() {
    if (descriptor_ >= 0) close(descriptor_);
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

UdpAddress UdpSocket::local() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(descriptor_, static_cast<sockaddr*>(static_cast<void*>(&address)), &size);
    return UdpAddress::of(address);
}

std::uint64_t UdpSocket::dropped_by_kernel() const {
    std::array<std::uint32_t, SK_MEMINFO_VARS> figures{};
    socklen_t size = sizeof figures;
    if (getsockopt(descriptor_, SOL_SOCKET, SO_MEMINFO, figures.data(), &size) != 0) return 0;
    return figures[SK_MEMINFO_DROPS];
}

}  // namespace thimble
