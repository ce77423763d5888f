#include "common/runtime/udp_socket.hpp"

#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <linux/sock_diag.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
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

std::uint16_t read_port(std::string_view text, const std::string& whole, const std::string& option) {
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size()) {
        throw Error(ExitCode::kUsage,
                    "{}: '{}' has no port from 0 to 65535; write it as HOST:PORT or PORT (IPv4)", option,
                    whole);
    }
    return port;
}

}  // namespace

UdpAddress UdpAddress::resolved(const std::string& host, std::uint16_t port, std::string_view advice) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found);
    if (error != 0 || found == nullptr) {
        throw Error(ExitCode::kNetwork, "cannot resolve host '{}': {}; {}", host, gai_strerror(error),
                    advice);
    }
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    freeaddrinfo(found);
    return {address.sin_addr.s_addr, htons(port)};
}

sockaddr_in UdpAddress::generic() const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = host;
    address.sin_port = port;
    return address;
}

std::string to_string(const UdpAddress& address) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&address.host);
    return fmt::format("{}.{}.{}.{}:{}", bytes[0], bytes[1], bytes[2], bytes[3], ntohs(address.port));
}

UdpAddress read_udp_address(const std::string& text, const std::string& option) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos) return {htonl(INADDR_ANY), htons(read_port(text, text, option))};
    const std::uint16_t port = read_port(std::string_view(text).substr(colon + 1), text, option);
    return UdpAddress::resolved(text.substr(0, colon), port,
                                fmt::format("give an IPv4 address to {}?", option));
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

UdpSocket UdpSocket::open() {
    UdpSocket made;
    made.descriptor_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (made.descriptor_ < 0) {
        throw Error(ExitCode::kNetwork, "cannot open a UDP socket: {}{}", std::strerror(errno),
                    descriptor_advice(errno));
    }
    return made;
}

UdpSocket UdpSocket::with_room() {
    UdpSocket made = open();
    enlarge(made.descriptor_, SO_RCVBUFFORCE, SO_RCVBUF);
    enlarge(made.descriptor_, SO_SNDBUFFORCE, SO_SNDBUF);
    made.stamp_arrivals();
    return made;
}

bool UdpSocket::stamp_arrivals() {
    const int on = 1;
    return setsockopt(descriptor_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) == 0;
}

UdpSocket UdpSocket::listening(const UdpAddress& local) {
    UdpSocket made = with_room();
    const sockaddr_in address = local.generic();
    if (bind(made.descriptor_, raw(address), sizeof address) != 0) {
        throw Error(ExitCode::kNetwork, "cannot listen on UDP {}: {}; {}", to_string(local),
                    std::strerror(errno),
                    errno == EADDRINUSE ? "another program has that port: choose another, or stop it"
                                        : "is that an address of this machine?");
    }
    return made;
}

UdpSocket UdpSocket::connected(const UdpAddress& remote) {
    UdpSocket made = with_room();
    const sockaddr_in address = remote.generic();
    if (connect(made.descriptor_, raw(address), sizeof address) != 0) {
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
