#include "netem/relay/datagram_batch.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <netinet/udp.h>

namespace thimble {
namespace {

constexpr std::size_t kRoomBytes = 65536;  // more than any UDP datagram has
constexpr std::size_t kMostJoinedBytes = 60000;

bool same_receiver(const SocketAddress& a, const SocketAddress& b) {
    return UdpAddress::of(a) == UdpAddress::of(b);
}

}  // namespace

// Pages that no datagram reaches cost nothing.
ReceiveBatch::ReceiveBatch() : data_(std::make_unique_for_overwrite<std::uint8_t[]>(kSize * kRoomBytes)) {
    for (std::size_t i = 0; i < kSize; ++i) {
        parts_[i] = {data_.get() + i * kRoomBytes, kRoomBytes};
        messages_[i].msg_hdr.msg_name = &from_[i];
        messages_[i].msg_hdr.msg_iov = &parts_[i];
        messages_[i].msg_hdr.msg_iovlen = 1;
        messages_[i].msg_hdr.msg_control = control_[i].bytes.data();
    }
}

std::size_t ReceiveBatch::receive(int descriptor, std::size_t most) {
    assert(most <= kSize);
    for (std::size_t i = 0; i < used_; ++i) {
        messages_[i].msg_hdr.msg_namelen = sizeof(SocketAddress);
        messages_[i].msg_hdr.msg_controllen = sizeof(Control);
    }
    int found = -1;
    bool closed = false;
    do {
        found = recvmmsg(descriptor, messages_.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
        closed = found < 0 && errno == ECONNREFUSED;
        closed_ports_ += closed ? 1 : 0;
    } while (found < 0 && (errno == EINTR || closed));
    used_ = found < 0 ? 0 : static_cast<std::size_t>(found);
    return used_;
}

ReceiveBatch::Datagram ReceiveBatch::operator[](std::size_t i) const {
    const std::uint8_t* data = data_.get() + i * kRoomBytes;
    const msghdr& header = messages_[i].msg_hdr;
    return {{data, messages_[i].msg_len},
            UdpAddress::of(from_[i]),
            kernel_stamp_ns(header),
            traffic_class_of(header)};
}

void SendBatch::add(Bytes bytes, const UdpAddress* to, std::uint8_t traffic_class, bool ipv4) {
    assert(!full());
    parts_[count_] = {const_cast<std::uint8_t*>(bytes.data()), bytes.size()};
    addressed_[count_] = to != nullptr;
    if (to != nullptr) to_[count_] = to->socket_address();
    traffic_class_[count_] = traffic_class;
    ipv4_[count_] = to != nullptr ? to->is_ipv4() : ipv4;
    ++count_;
}

// How many datagrams from here on are of one size and have one receiver.
std::size_t SendBatch::same_from(std::size_t first) const {
    std::size_t end = first + 1;
    const auto same = [&](std::size_t i) {
        return parts_[i].iov_len == parts_[first].iov_len && addressed_[i] == addressed_[first] &&
               traffic_class_[i] == traffic_class_[first] &&
               (!addressed_[i] || same_receiver(to_[i], to_[first]));
    };
    if (parts_[first].iov_len > kLongestJoined) return 1;
    while (end < count_ && (end - first + 1) * parts_[first].iov_len <= kMostJoinedBytes && same(end)) ++end;
    return end - first;
}

// From this datagram on, as messages to the kernel.
std::size_t SendBatch::gather(std::size_t first, bool joins) {
    std::size_t messages = 0;
    while (first < count_) {
        const std::size_t run = joins ? same_from(first) : 1;
        const std::size_t count = run >= kJoin ? run : 1;
        fill(messages++, {first, count});
        first += count;
    }
    return messages;
}

void SendBatch::fill(std::size_t message, const Piece& piece) {
    pieces_[message] = piece;
    msghdr& header = messages_[message].msg_hdr;
    header = {};
    header.msg_iov = &parts_[piece.first];
    header.msg_iovlen = piece.count;
    if (addressed_[piece.first]) {
        header.msg_name = &to_[piece.first];
        header.msg_namelen = to_[piece.first].size();
    }
    const int traffic_class = traffic_class_[piece.first];
    if (traffic_class != 0) {
        const bool ipv4 = ipv4_[piece.first];
        put(message, ipv4 ? IPPROTO_IP : IPPROTO_IPV6, ipv4 ? IP_TOS : IPV6_TCLASS, traffic_class);
    }
    if (piece.count > 1)
        put(message, SOL_UDP, UDP_SEGMENT, static_cast<std::uint16_t>(parts_[piece.first].iov_len));
}

// One more control message.
template <class Value>
void SendBatch::put(std::size_t message, int level, int type, Value value) {
    msghdr& header = messages_[message].msg_hdr;
    Control& control = control_[message];
    header.msg_control = control.bytes.data();
    auto* added = static_cast<cmsghdr*>(static_cast<void*>(control.bytes.data() + header.msg_controllen));
    header.msg_controllen += CMSG_SPACE(sizeof value);
    added->cmsg_level = level;
    added->cmsg_type = type;
    added->cmsg_len = CMSG_LEN(sizeof value);
    std::memcpy(CMSG_DATA(added), &value, sizeof value);
}

void SendBatch::mark(const Piece& piece, bool accepted) {
    std::fill_n(accepted_.begin() + static_cast<std::ptrdiff_t>(piece.first), piece.count, accepted);
}

// Up to the first joined piece that is refused: returns the datagram where that begins, else how many there are. A
// failure stops sendmmsg at the message that failed. A connected socket reports the error of an earlier datagram
// (port closed) once. It says nothing about this datagram, which is tried again.
std::size_t SendBatch::send_pieces(int descriptor, std::size_t pieces) {
    std::size_t done = 0;
    bool again = true;
    while (done < pieces) {
        const int sent = sendmmsg(descriptor, messages_.data() + done, static_cast<unsigned>(pieces - done),
                                  MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent > 0) {
            for (int i = 0; i < sent; ++i) mark(pieces_[done++], true);
            again = true;
        } else if (again && (errno == ECONNREFUSED || errno == EINTR)) {
            closed_ports_ += errno == ECONNREFUSED ? 1 : 0;
            again = false;
        } else if (pieces_[done].count > 1) {
            return pieces_[done].first;
        } else {
            mark(pieces_[done++], false);
            again = true;
        }
    }
    return count_;
}

std::span<const bool> SendBatch::send(int descriptor) {
    bool joins = joins_;
    for (std::size_t first = 0; first < count_;) {
        first = send_pieces(descriptor, gather(first, joins));
        if (first == count_) break;
        joins = false;
        const bool full = errno == EAGAIN || errno == ENOBUFS;
        cannot_join_ = !full;  // this path or this kernel cannot
        joins_ = joins_ && full;
    }
    const std::size_t all = count_;
    count_ = 0;
    return {accepted_.data(), all};
}

}  // namespace thimble
