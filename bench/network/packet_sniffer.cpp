#include "bench/network/packet_sniffer.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <linux/filter.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

constexpr std::size_t kHeaders = 20 + 8;  // IPv4 without options, UDP
constexpr std::size_t kMostPacket = 2048;

// The kernel leaves out whatever else there is on loopback, a flood above all.
void hear_only(int socket, std::uint16_t port, std::uint16_t own_port) {
    std::array<sock_filter, 10> program{{
        BPF_STMT(BPF_LD | BPF_B | BPF_ABS, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x45, 0, 7),  // IPv4 without options
        BPF_STMT(BPF_LD | BPF_B | BPF_ABS, 9),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, IPPROTO_UDP, 0, 5),
        BPF_STMT(BPF_LD | BPF_H | BPF_ABS, 22),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, port, 0, 3),
        BPF_STMT(BPF_LD | BPF_H | BPF_ABS, 20),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, own_port, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, kMostPacket),
        BPF_STMT(BPF_RET | BPF_K, 0),
    }};
    const sock_fprog filter{program.size(), program.data()};
    setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter);
}

}  // namespace

PacketSniffer::PacketSniffer(std::uint16_t port, std::uint16_t own_port) : buffer_(kMostPacket) {
    socket_ = socket(AF_PACKET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ >= 0) hear_only(socket_, port, own_port);
    sockaddr_ll loopback{};
    loopback.sll_family = AF_PACKET;
    loopback.sll_protocol = htons(ETH_P_IP);
    loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    if (socket_ >= 0 && bind(socket_, reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback) == 0)
        return;
    const int why = errno;
    if (socket_ >= 0) close(socket_);
    throw Error(ExitCode::kNetwork,
                fmt::format("loopback cannot be listened to: {}; run as root, or with CAP_NET_RAW",
                            std::strerror(why)));
}

PacketSniffer::~PacketSniffer() { close(socket_); }

const std::vector<std::uint8_t>& PacketSniffer::newest() {
    datagram_.clear();
    for (;;) {
        const ssize_t size = recv(socket_, buffer_.data(), buffer_.size(), 0);
        if (size <= static_cast<ssize_t>(kHeaders)) {
            if (size < 0) return datagram_;
            continue;
        }
        datagram_.assign(buffer_.begin() + kHeaders, buffer_.begin() + size);
    }
}

}  // namespace thimble
