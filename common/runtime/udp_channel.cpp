#include "common/runtime/udp_channel.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// A few hundred messages: bursts after a stall must not be lost in the kernel.
constexpr int kBufferBytes = 1 << 20;

sockaddr_in resolve(const Endpoint& endpoint) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int error = getaddrinfo(endpoint.host.c_str(), nullptr, &hints, &found);
    if (error != 0 || found == nullptr) {
        throw Error(ExitCode::kNetwork,
                    fmt::format("cannot resolve host '{}': {}; check [network] in the configuration",
                                endpoint.host, gai_strerror(error)));
    }
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    freeaddrinfo(found);
    address.sin_port = htons(endpoint.port);
    return address;
}

const sockaddr* generic(const sockaddr_in& address) {
    return static_cast<const sockaddr*>(static_cast<const void*>(&address));
}

}  // namespace

bool means_this_machine(const std::string& host) {
    constexpr std::uint32_t kLoopback = 127;
    try {
        const std::uint32_t address = ntohl(resolve({host, 0}).sin_addr.s_addr);
        return address >> 24U == kLoopback || address == INADDR_ANY;
    } catch (const Error&) {
        return false;  // whoever needs it says so
    }
}

UdpChannel::UdpChannel(const std::optional<Endpoint>& local, const Endpoint& remote)
    : remote_(resolve(remote)) {
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) {
        throw Error(ExitCode::kNetwork, fmt::format("cannot open a UDP socket: {}", std::strerror(errno)));
    }
    for (const int option : {SO_RCVBUF, SO_SNDBUF}) {
        setsockopt(socket_, SOL_SOCKET, option, &kBufferBytes, sizeof kBufferBytes);
    }
    try {
        if (local) bind_to(*local);
    } catch (...) {
        close(socket_);
        throw;
    }
}

void UdpChannel::bind_to(const Endpoint& local) {
    const sockaddr_in address = resolve(local);
    if (bind(socket_, generic(address), sizeof address) == 0) return;
    const int error = errno;
    const char* advice = error == EADDRINUSE
                             ? "is another thimble program running there? Stop it, or choose another "
                               "base_port in [network]"
                             : "check the host in [network]";
    throw Error(ExitCode::kNetwork, fmt::format("cannot listen on UDP {}:{}: {}; {}", local.host, local.port,
                                                std::strerror(error), advice));
}

UdpChannel::~UdpChannel() { close(socket_); }

void UdpChannel::send(Bytes datagram) {
    const auto sent = sendto(socket_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                             generic(remote_), sizeof remote_);
    ++(sent < 0 ? counters_.send_failed : counters_.sent);
}

Bytes UdpChannel::receive() {
    for (;;) {
        sockaddr_in source{};
        socklen_t length = sizeof source;
        const auto size = recvfrom(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT,
                                   static_cast<sockaddr*>(static_cast<void*>(&source)), &length);
        // An ICMP "nobody listens" for an earlier send is reported here once; it is the peer's watchdog's
        // business.
        if (size < 0 && (errno == ECONNREFUSED || errno == EINTR)) continue;
        if (size < 0) return {};
        if (source.sin_addr.s_addr != remote_.sin_addr.s_addr) {
            ++counters_.foreign_source;
        } else if (static_cast<std::size_t>(size) > kMaxDatagramBytes) {
            ++counters_.too_long;
        } else if (size > 0) {
            ++counters_.received;
            return {buffer_.data(), static_cast<std::size_t>(size)};
        }
    }
}

}  // namespace thimble
