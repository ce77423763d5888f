#include "thimble/link_test/probe_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <linux/errqueue.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "common/runtime/wall_clock.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {
namespace {

// More than half the width of the pairs of readings that are used.
constexpr Duration kStampDoubt = std::chrono::microseconds{5};

struct Ancillary {
    alignas(cmsghdr) std::array<std::uint8_t, 256> bytes;
};

msghdr message_into(iovec& part, Ancillary& room) {
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = room.bytes.data();
    message.msg_controllen = room.bytes.size();
    return message;
}

template <class Value>
std::optional<Value> ancillary(const msghdr& message, int level, int type) {
    for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
         c = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(c))) {
        if (c->cmsg_level != level || c->cmsg_type != type) continue;
        Value value{};
        std::memcpy(&value, CMSG_DATA(c), sizeof value);
        return value;
    }
    return std::nullopt;
}

}  // namespace

SessionTime ArrivalClock::arrival(std::int64_t stamp_realtime_ns) {
    const ClockPair pair = read_clock_pair();
    if (stamp_realtime_ns == 0 || pair.after - pair.before > kStampDoubt) return pair.after;
    clock_.update(pair);
    return std::min(clock_.to_session(stamp_realtime_ns, pair.after) + kStampDoubt, pair.after);
}

void forbid_fragments(const UdpSocket& socket) {
    const int probe = IP_PMTUDISC_PROBE;
    setsockopt(socket.descriptor(), IPPROTO_IP, IP_MTU_DISCOVER, &probe, sizeof probe);
}

ProbeSocket::ProbeSocket(const UdpAddress& remote)
    : socket_(UdpSocket::connected(remote)),
      buffer_(std::make_unique_for_overwrite<std::uint8_t[]>(kLargestProbeBytes)) {
    forbid_fragments(socket_);
    const int on = 1;
    setsockopt(socket_.descriptor(), IPPROTO_IP, IP_RECVERR, &on, sizeof on);
}

int ProbeSocket::send(Bytes datagram) {
    const auto sent =
        ::send(socket_.descriptor(), datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent < 0 ? errno : 0;
}

std::optional<ProbeSocket::Received> ProbeSocket::receive() {
    for (;;) {
        iovec part{buffer_.get(), kLargestProbeBytes};
        Ancillary room{};
        msghdr message = message_into(part, room);
        const auto size = recvmsg(socket_.descriptor(), &message, MSG_DONTWAIT);
        if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::nullopt;
        if (size < 0 && errno == EBADF) return std::nullopt;
        if (size < 0) continue;  // a pending error, told once; its cause lies in the error queue
        const auto stamp = ancillary<timespec>(message, SOL_SOCKET, SCM_TIMESTAMPNS);
        const std::int64_t stamp_ns =
            stamp ? std::int64_t{stamp->tv_sec} * 1'000'000'000 + stamp->tv_nsec : 0;
        return Received{{buffer_.get(), static_cast<std::size_t>(size)}, clock_.arrival(stamp_ns)};
    }
}

void ProbeSocket::take_errors(PortEvidence& evidence) {
    for (;;) {
        std::array<std::uint8_t, 64> offender{};
        iovec part{offender.data(), offender.size()};
        Ancillary room{};
        msghdr message = message_into(part, room);
        if (recvmsg(socket_.descriptor(), &message, MSG_ERRQUEUE | MSG_DONTWAIT) < 0) return;
        const auto error = ancillary<sock_extended_err>(message, IPPROTO_IP, IP_RECVERR);
        if (!error) continue;
        evidence.error = static_cast<int>(error->ee_errno);
        evidence.by_icmp = error->ee_origin == SO_EE_ORIGIN_ICMP;
        evidence.icmp_code = error->ee_code;
    }
}

}  // namespace thimble
