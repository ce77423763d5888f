// A UDP socket that never blocks, and the addresses of its peers (IPv4 and IPv6).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <netinet/in.h>
#include <string>
#include <string_view>
#include <sys/socket.h>

namespace thimble {

// An address of either family as the kernel takes it.
union SocketAddress {
    sockaddr_in6 v6;  // the longest first: {} leaves nothing unset
    sockaddr_in v4;
    sockaddr any;

    socklen_t size() const { return any.sa_family == AF_INET6 ? sizeof v6 : sizeof v4; }
};

struct UdpAddress {
    std::uint32_t host = 0;  // of IPv4; both in network byte order
    std::uint16_t port = 0;
    bool ipv6 = false;                     // then `host` is 0 and these count
    std::array<std::uint8_t, 16> host6{};  // as in a packet
    std::uint32_t scope = 0;               // the interface of a link-local address

    static UdpAddress of(const sockaddr_in& address) { return {address.sin_addr.s_addr, address.sin_port}; }
    static UdpAddress of(const SocketAddress& address);
    // All addresses of this machine, of both families. Its socket has IPv4 peers in IPv6's mapped form.
    static UdpAddress all(std::uint16_t port_in_network_order);
    // Throws Error (network) with the name and `advice` if `host` cannot be resolved.
    static UdpAddress resolved(const std::string& host, std::uint16_t port, std::string_view advice);
    sockaddr_in generic() const;  // of an IPv4 address
    SocketAddress socket_address() const;
    bool unspecified() const { return host == 0 && host6 == std::array<std::uint8_t, 16>{}; }
    // An IPv4 peer, however its socket writes that.
    bool is_ipv4() const;
    std::size_t hash() const;
    bool operator==(const UdpAddress&) const = default;
};

std::string to_string(const UdpAddress& address);  // "127.0.0.1:9000", "[::1]:9000"

// PORT or HOST:PORT, an IPv6 address in brackets. A bare port means all of this machine's IPv4 addresses. Port 0: the
// kernel's choice. Of a name with addresses of both families IPv4 is taken.
// Throws Error (usage) naming `option` if the text is none of these, Error (network) if the host is unknown.
UdpAddress read_udp_address(const std::string& text, const std::string& option);

inline const sockaddr* raw(const sockaddr_in& address) {
    return static_cast<const sockaddr*>(static_cast<const void*>(&address));
}

// When the kernel had a datagram, on its realtime clock; 0 if it did not say.
std::int64_t kernel_stamp_ns(const msghdr& message);
// The DSCP and ECN bits that it came with; 0 if the kernel did not say.
std::uint8_t traffic_class_of(const msghdr& message);

class UdpSocket {
  public:
    UdpSocket() = default;
    static UdpSocket open(int family = AF_INET);  // bound to nothing. Throws Error (network)
    // Both with room for a burst of some thousand datagrams while this program cannot run, and with the kernel's stamps.
    // Throws Error (network) if the port is taken.
    static UdpSocket listening(const UdpAddress& local);
    // To one peer from a port of the kernel's choice; datagrams of others never arrive. Throws Error (network).
    static UdpSocket connected(const UdpAddress& remote);

    ~UdpSocket();
    UdpSocket(UdpSocket&& other) noexcept;
    UdpSocket& operator=(UdpSocket&& other) noexcept;

    int descriptor() const { return descriptor_; }
    UdpAddress local() const;
    bool stamp_arrivals();      // false: this kernel cannot
    void tell_traffic_class();  // of what arrives
    // Datagrams that came and found no room in the kernel (SO_MEMINFO).
    std::uint64_t dropped_by_kernel() const;

  private:
    static UdpSocket with_room(const UdpAddress& address);
    int descriptor_ = -1;
};

}  // namespace thimble
