#include "common/runtime/udp_channel.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

// A few hundred messages: bursts after a stall must not be lost in the kernel.
constexpr int kBufferBytes = 1 << 20;
// The most that a kernel stamp may be off as session time: more than half the width of the pairs of readings used.
constexpr Duration kStampDoubt = std::chrono::microseconds{5};

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
        return false;  // opening a channel to it reports the error
    }
}

bool leaves_this_machine(const std::string& host) {
    constexpr std::uint32_t kLoopbackNet = 127;
    try {
        return ntohl(resolve({host, 0}).sin_addr.s_addr) >> 24U != kLoopbackNet;
    } catch (const Error&) {
        return true;
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

void UdpChannel::send(Bytes datagram) { send_to(remote_, datagram); }

void UdpChannel::answer(Bytes datagram) {
    if (source_.sin_port != 0) send_to(source_, datagram);
}

void UdpChannel::send_to(const sockaddr_in& address, Bytes datagram) {
    const auto sent = sendto(socket_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                             generic(address), sizeof address);
    ++(sent < 0 ? counters_.send_failed : counters_.sent);
}

Bytes UdpChannel::take() {
    for (int refused = 0; refused < kMostRefusedAtOnce; ++refused) {
        iovec part{buffer_.data(), buffer_.size()};
        alignas(cmsghdr) std::array<std::uint8_t, 64> control{};
        msghdr message{};
        message.msg_name = &source_;
        message.msg_namelen = sizeof source_;
        message.msg_iov = &part;
        message.msg_iovlen = 1;
        message.msg_control = stamping_ ? control.data() : nullptr;
        message.msg_controllen = stamping_ ? control.size() : 0;
        const auto size = recvmsg(socket_, &message, MSG_DONTWAIT);
        // An ICMP "port unreachable" for an earlier send is reported here once. The peer's watchdog handles it.
        if (size < 0 && (errno == ECONNREFUSED || errno == EINTR)) continue;
        if (size < 0) {
            known_empty_ = watched_;
            return {};
        }
        if (!from_peer(static_cast<std::size_t>(size))) continue;
        if (stamping_) arrival_ = arrival_of(message);
        return {buffer_.data(), static_cast<std::size_t>(size)};
    }
    return {};
}

// Counts it. An empty datagram carries nothing.
bool UdpChannel::from_peer(std::size_t size) {
    const in_addr_t host = source_.sin_addr.s_addr;
    if (host != remote_.sin_addr.s_addr && std::find(others_.begin(), others_.end(), host) == others_.end()) {
        ++counters_.foreign_source;
    } else if (size > kMaxDatagramBytes) {
        ++counters_.too_long;
    } else if (size > 0) {
        ++counters_.received;
        return true;
    }
    return false;
}

void UdpChannel::listen_also_to(const std::vector<std::string>& hosts) {
    others_.reserve(others_.size() + hosts.size());
    for (const std::string& host : hosts) others_.push_back(resolve({host, 0}).sin_addr.s_addr);
}

void UdpChannel::stamp_arrivals() {
    const int on = 1;
    stamping_ = setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) == 0;
}

// Without a stamp that can be trusted: now, which is later than the arrival in any case.
SessionTime UdpChannel::arrival_of(const msghdr& message) {
    const ClockPair pair = read_clock_pair();
    if (pair.after - pair.before > kStampDoubt) return pair.after;
    stamp_clock_.update(pair);
    for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
         c = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(c))) {
        if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
        const std::int64_t stamp_ns = std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec;
        return std::min(stamp_clock_.to_session(stamp_ns, pair.after) + kStampDoubt, pair.after);
    }
    return pair.after;
}

}  // namespace thimble
