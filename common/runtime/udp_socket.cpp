#include "common/runtime/udp_socket.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <linux/sock_diag.h>
#include <netdb.h>
#include <optional>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// Root gets it whatever net.core.rmem_max says.
constexpr int kRoomBytes = 4 << 20;

void enlarge(int descriptor, int forced, int polite) {
    if (setsockopt(descriptor, SOL_SOCKET, forced, &kRoomBytes, sizeof kRoomBytes) != 0) {
        setsockopt(descriptor, SOL_SOCKET, polite, &kRoomBytes, sizeof kRoomBytes);
    }
}

// The first address of this family, if there is one.
std::optional<UdpAddress> look_up(const std::string& host, std::uint16_t port, int family, int& error) {
    addrinfo hints{};
    hints.ai_family = family;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    error = getaddrinfo(host.c_str(), nullptr, &hints, &found);
    if (error != 0 || found == nullptr) return std::nullopt;
    SocketAddress address{};
    std::memcpy(&address, found->ai_addr, std::min<std::size_t>(found->ai_addrlen, sizeof address));
    freeaddrinfo(found);
    UdpAddress made = UdpAddress::of(address);
    made.port = htons(port);
    return made;
}

void set(int descriptor, int level, int name, int value) {
    setsockopt(descriptor, level, name, &value, sizeof value);
}

constexpr std::array<std::uint8_t, 12> kMapped{0, 0, 0, 0, 0,    0,
                                               0, 0, 0, 0, 0xff, 0xff};  // an IPv4 address follows

// A socket of IPv6 alone has no route to an IPv4 address.
UdpAddress unmapped(const UdpAddress& address) {
    if (!address.is_ipv4()) return address;
    UdpAddress made{0, address.port};
    std::memcpy(&made.host, address.host6.data() + kMapped.size(), sizeof made.host);
    return made;
}

}  // namespace

UdpAddress UdpAddress::resolved(const std::string& host, std::uint16_t port, std::string_view advice) {
    int error = 0;
    if (const auto found = look_up(host, port, AF_INET, error)) return *found;
    throw Error(ExitCode::kNetwork, "cannot resolve host '{}': {}; {}", host, gai_strerror(error), advice);
}

UdpAddress UdpAddress::of(const SocketAddress& address) {
    if (address.any.sa_family != AF_INET6) return of(address.v4);
    UdpAddress made;
    made.port = address.v6.sin6_port;
    made.ipv6 = true;
    std::memcpy(made.host6.data(), &address.v6.sin6_addr, made.host6.size());
    made.scope = address.v6.sin6_scope_id;
    return made;
}

UdpAddress UdpAddress::all(std::uint16_t port_in_network_order) {
    UdpAddress made;
    made.port = port_in_network_order;
    made.ipv6 = true;
    return made;
}

SocketAddress UdpAddress::socket_address() const {
    SocketAddress address{};
    if (!ipv6) {
        address.v4 = generic();
        return address;
    }
    address.v6.sin6_family = AF_INET6;
    address.v6.sin6_port = port;
    std::memcpy(&address.v6.sin6_addr, host6.data(), host6.size());
    address.v6.sin6_scope_id = scope;
    return address;
}

bool UdpAddress::is_ipv4() const {
    return !ipv6 || std::equal(kMapped.begin(), kMapped.end(), host6.begin());
}

std::size_t UdpAddress::hash() const {
    std::array<std::uint64_t, 2> halves{};
    std::memcpy(halves.data(), host6.data(), host6.size());
    constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15U;  // spreads what differs in few bits
    std::uint64_t mixed = (std::uint64_t{host} << 16 | port) ^ (halves[0] * kOdd) ^ scope;
    mixed = (mixed ^ mixed >> 29) * kOdd ^ halves[1];
    return (mixed ^ mixed >> 32) * kOdd;
}

sockaddr_in UdpAddress::generic() const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = host;
    address.sin_port = port;
    return address;
}

std::string to_string(const UdpAddress& address) {
    if (address.ipv6) {
        std::array<char, INET6_ADDRSTRLEN> text{};
        inet_ntop(AF_INET6, address.host6.data(), text.data(), text.size());
        const std::string scope = address.scope == 0 ? "" : fmt::format("%{}", address.scope);
        return fmt::format("[{}{}]:{}", text.data(), scope, ntohs(address.port));
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&address.host);
    return fmt::format("{}.{}.{}.{}:{}", bytes[0], bytes[1], bytes[2], bytes[3], ntohs(address.port));
}

UdpAddress read_udp_address(const std::string& text, const std::string& option) {
    const auto given = endpoint_in(text, "0.0.0.0");
    if (!given)
        throw Error(ExitCode::kUsage,
                    "{}: '{}' is not PORT, HOST:PORT or [IPv6]:PORT, with a port from 0 to 65535", option,
                    text);
    auto [host, port] = *given;
    const bool bracketed = host.size() > 1 && host.front() == '[' && host.back() == ']';
    if (!bracketed && host.find(':') != std::string::npos) {
        throw Error(ExitCode::kUsage, "{}: '{}' needs brackets around its IPv6 address: [::1]:9000", option,
                    text);
    }
    if (bracketed) host = host.substr(1, host.size() - 2);
    int error = 0;
    if (const auto found = bracketed ? std::nullopt : look_up(host, port, AF_INET, error)) return *found;
    if (const auto found = look_up(host, port, AF_INET6, error)) return unmapped(*found);
    throw Error(ExitCode::kNetwork, "cannot resolve host '{}': {}; give an address to {}", host,
                gai_strerror(error), option);
}

std::uint8_t traffic_class_of(const msghdr& message) {
    for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
         c = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(c))) {
        // A byte in IPv4, an int in IPv6; no machine that this runs on has the low byte last.
        const bool known = (c->cmsg_level == IPPROTO_IP && c->cmsg_type == IP_TOS) ||
                           (c->cmsg_level == IPPROTO_IPV6 && c->cmsg_type == IPV6_TCLASS);
        if (known) return *CMSG_DATA(c);
    }
    return 0;
}

std::int64_t kernel_stamp_ns(const msghdr& message) {
    for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
         c = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(c))) {
        if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
        return std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec;
    }
    return 0;
}

UdpSocket UdpSocket::open(int family) {
    UdpSocket made;
    made.descriptor_ = socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (made.descriptor_ < 0) {
        throw Error(ExitCode::kNetwork, "cannot open a UDP socket: {}{}", std::strerror(errno),
                    descriptor_advice(errno));
    }
    return made;
}

UdpSocket UdpSocket::with_room(const UdpAddress& address) {
    UdpSocket made = open(address.ipv6 ? AF_INET6 : AF_INET);
    if (address.ipv6) set(made.descriptor_, IPPROTO_IPV6, IPV6_V6ONLY, address.unspecified() ? 0 : 1);
    enlarge(made.descriptor_, SO_RCVBUFFORCE, SO_RCVBUF);
    enlarge(made.descriptor_, SO_SNDBUFFORCE, SO_SNDBUF);
    made.stamp_arrivals();
    return made;
}

bool UdpSocket::stamp_arrivals() {
    const int on = 1;
    return setsockopt(descriptor_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) == 0;
}

// A socket of both families may get either, so it asks for both; the other family's option is refused without harm.
void UdpSocket::tell_traffic_class() {
    set(descriptor_, IPPROTO_IP, IP_RECVTOS, 1);
    set(descriptor_, IPPROTO_IPV6, IPV6_RECVTCLASS, 1);
}

UdpSocket UdpSocket::listening(const UdpAddress& local) {
    UdpSocket made = with_room(local);
    const SocketAddress address = local.socket_address();
    if (bind(made.descriptor_, &address.any, address.size()) != 0) {
        throw Error(ExitCode::kNetwork, "cannot listen on UDP {}: {}; {}", to_string(local),
                    std::strerror(errno),
                    errno == EADDRINUSE ? "another program uses that port: choose another port, or stop it"
                                        : "is that an address of this machine?");
    }
    return made;
}

UdpSocket UdpSocket::connected(const UdpAddress& remote) {
    UdpSocket made = with_room(remote);
    const SocketAddress address = remote.socket_address();
    if (connect(made.descriptor_, &address.any, address.size()) != 0) {
        throw Error(ExitCode::kNetwork, "cannot send to UDP {}: {}; is there a route to it?",
                    to_string(remote), std::strerror(errno));
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
    SocketAddress address{};
    socklen_t size = sizeof address;
    getsockname(descriptor_, &address.any, &size);
    return UdpAddress::of(address);
}

std::uint64_t UdpSocket::dropped_by_kernel() const {
    std::array<std::uint32_t, SK_MEMINFO_VARS> figures{};
    socklen_t size = sizeof figures;
    if (getsockopt(descriptor_, SOL_SOCKET, SO_MEMINFO, figures.data(), &size) != 0) return 0;
    return figures[SK_MEMINFO_DROPS];
}

}  // namespace thimble
