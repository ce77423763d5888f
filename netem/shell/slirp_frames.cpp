#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <sys/socket.h>
#include <sys/uio.h>
#include <vector>

#include "netem/shell/ip_packet.hpp"

namespace thimble {
namespace {

using Octets = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 6> kGatewayMac{0x52, 0x55, 0x0A, 0x00, 0x02, 0x02};  // libslirp's
constexpr std::array<std::uint8_t, 6> kOwnMac{0x02, 0x54, 0x48, 0x4D, 0x42, 0x01};
constexpr std::uint16_t kTypeIp4 = 0x0800, kTypeArp = 0x0806, kTypeIp6 = 0x86DD;

template <class Range>
void append(Octets& to, const Range& bytes) {
    to.insert(to.end(), std::begin(bytes), std::end(bytes));
}

Octets address_bytes(int family, const char* text) {
    Octets bytes(family == AF_INET ? 4 : 16);
    inet_pton(family, text, bytes.data());
    return bytes;
}

std::array<std::uint8_t, kEthernetBytes> header(std::uint16_t type) {
    std::array<std::uint8_t, kEthernetBytes> bytes{};
    std::copy(kGatewayMac.begin(), kGatewayMac.end(), bytes.begin());
    std::copy(kOwnMac.begin(), kOwnMac.end(), bytes.begin() + 6);
    bytes[12] = static_cast<std::uint8_t>(type >> 8);
    bytes[13] = static_cast<std::uint8_t>(type);
    return bytes;
}

bool send_parts(int socket, std::uint16_t type, Bytes payload) {
    auto head = header(type);
    std::array<iovec, 2> parts{
        {{head.data(), head.size()}, {const_cast<std::uint8_t*>(payload.data()), payload.size()}}};  // NOLINT
    msghdr message{};
    message.msg_iov = parts.data();
    message.msg_iovlen = parts.size();
    return sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0;
}

// RFC 826: who has the gateway's address? The asker is noted.
Octets arp_request() {
    Octets packet{0, 1, 8, 0, 6, 4, 0, 1};
    append(packet, kOwnMac);
    append(packet, address_bytes(AF_INET, kSlirpOwn4));
    append(packet, std::array<std::uint8_t, 6>{});
    append(packet, address_bytes(AF_INET, kSlirpHost4));
    return packet;
}

// RFC 1071, of the ICMPv6 message and its pseudo header (RFC 8200, 8.1).
std::uint16_t icmp6_checksum(const Octets& packet) {
    std::uint32_t sum = static_cast<std::uint32_t>(packet.size() - 40) + IPPROTO_ICMPV6;
    for (std::size_t i = 8; i + 1 < packet.size(); i += 2)
        sum += static_cast<std::uint32_t>(packet[i] << 8 | packet[i + 1]);
    while (sum >> 16 != 0) sum = (sum & 0xFFFF) + (sum >> 16);
    return static_cast<std::uint16_t>(~sum);
}

// RFC 4861, 4.4, with the option of the sender's own link address.
Octets neighbour_advertisement() {
    const Octets own = address_bytes(AF_INET6, kSlirpOwn6);
    Octets packet{0x60, 0, 0, 0, 0, 32, IPPROTO_ICMPV6, 255};
    append(packet, own);
    append(packet, address_bytes(AF_INET6, kSlirpHost6));
    append(packet, Octets{136, 0, 0, 0, 0x20, 0, 0, 0});  // override
    append(packet, own);
    append(packet, Octets{2, 1});
    append(packet, kOwnMac);
    const std::uint16_t sum = icmp6_checksum(packet);
    packet[42] = static_cast<std::uint8_t>(sum >> 8);
    packet[43] = static_cast<std::uint8_t>(sum);
    return packet;
}

}  // namespace

Bytes ip_of_frame(Bytes frame) {
    if (frame.size() < kEthernetBytes) return {};
    const auto type = static_cast<std::uint16_t>(frame[12] << 8 | frame[13]);
    return type == kTypeIp4 || type == kTypeIp6 ? frame.subspan(kEthernetBytes) : Bytes{};
}

bool send_frame(int socket, Bytes ip_packet) {
    return send_parts(socket, ip_packet[0] >> 4 == 6 ? kTypeIp6 : kTypeIp4, ip_packet);
}

void announce_addresses(int socket) {
    send_parts(socket, kTypeArp, arp_request());
    send_parts(socket, kTypeIp6, neighbour_advertisement());
}

}  // namespace thimble
