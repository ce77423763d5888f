// A UDP socket (IPv4) that never blocks, and the addresses of its peers.
#pragma once

#include <cstdint>
#include <netinet/in.h>
#include <string>
#include <string_view>
#include <sys/socket.h>

namespace thimble {

struct UdpAddress {
    std::uint32_t host = 0;  // both in network byte order
    std::uint16_t port = 0;

    static UdpAddress of(const sockaddr_in& address) { return {address.sin_addr.s_addr, address.sin_port}; }
    // Throws Error (network) with the name and `advice` if `host` cannot be resolved.
    static UdpAddress resolved(const std::string& host, std::uint16_t port, std::string_view advice);
    sockaddr_in generic() const;
    std::uint64_t number() const { return (std::uint64_t{host} << 16) | port; }  // to compare and hash
    bool operator==(const UdpAddress&) const = default;
};

std::string to_string(const UdpAddress& address);  // "127.0.0.1:9000"

// "9000", "10.0.0.1:9000" or "host:9000"; a bare port means all of this machine's addresses. Port 0: the kernel's choice.
// Throws Error (usage) naming `option` if the text is none of these, Error (network) if the host is unknown.
UdpAddress read_udp_address(const std::string& text, const std::string& option);

inline const sockaddr* raw(const sockaddr_in& address) {
    return static_cast<const sockaddr*>(static_cast<const void*>(&address));
}

// When the kernel had a datagram, on its realtime clock; 0 if it did not say.
std::int64_t kernel_stamp_ns(const msghdr& message);

class UdpSocket {
  public:
    UdpSocket() = default;
    static UdpSocket open();  // bound to nothing. Throws Error (network)
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
    bool stamp_arrivals();  // false: this kernel cannot
    // Datagrams that came and found no room in the kernel (SO_MEMINFO).
    std::uint64_t dropped_by_kernel() const;

  private:
    static UdpSocket with_room();
    int descriptor_ = -1;
};

}  // namespace thimble
