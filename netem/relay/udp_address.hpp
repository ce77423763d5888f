// IPv4 address and port of a UDP peer, as one number to compare and hash.
#pragma once

#include <compare>
#include <cstdint>
#include <netinet/in.h>
#include <string>

namespace thimble {

struct UdpAddress {
    std::uint32_t host = 0;  // both in network byte order
    std::uint16_t port = 0;

    static UdpAddress of(const sockaddr_in& address) { return {address.sin_addr.s_addr, address.sin_port}; }
    sockaddr_in generic() const;
    std::uint64_t number() const { return (std::uint64_t{host} << 16) | port; }
    bool operator==(const UdpAddress&) const = default;
};

std::string to_string(const UdpAddress& address);  // "127.0.0.1:9000"

// "9000", "10.0.0.1:9000" or "host:9000"; a bare port means all of this machine's addresses. Port 0: the kernel's choice.
// Throws Error (usage) naming `option` if the text is none of these, Error (network) if the host is unknown.
UdpAddress read_udp_address(const std::string& text, const std::string& option);

}  // namespace thimble
