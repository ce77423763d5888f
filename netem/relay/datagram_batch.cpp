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

bool same_receiver(const sockaddr_in& a, const sockaddr_in& b) {
    return a.sin_port == b.sin_port && a.sin_addr.s_addr == b.sin_addr.s_addr;
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
        messages_[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
        messages_[i].msg_hdr.msg_controllen = sizeof(Control);
    }
    int found = -1;
    do {
        found = recvmmsg(descriptor, messages_.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
    } while (found < 0 && (errno == EINTR || errno == ECONNREFUSED));
    used_ = found < 0 ? 0 : static_cast<std::size_t>(found);
    return used_;
}

ReceiveBatch::Datagram ReceiveBatch::operator[](std::size_t i) const {
    const std::uint8_t* data = data_.get() + i * kRoomBytes;
    return {{data, messages_[i].msg_len}, UdpAddress::of(from_[i]), kernel_stamp_ns(messages_[i].msg_hdr)};
}

void SendBatch::add(Bytes bytes, const UdpAddress* to) {
    assert(!full());
    parts_[count_] = {const_cast<std::uint8_t*>(bytes.data()), bytes.size()};
    addressed_[count_] = to != nullptr;
    if (to != nullptr) to_[count_] = to->generic();
    ++count_;
}

// How many datagrams from here on are of one size and have one receiver.
std::size_t SendBatch::same_from(std::size_t first) const {
    std::size_t end = first + 1;
    const auto same = [&](std::size_t i) {
        return parts_[i].iov_len == parts_[first].iov_len && addressed_[i] == addressed_[first] &&
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
        header.msg_namelen = sizeof(sockaddr_in);
    }
    if (piece.count == 1) return;
    header.msg_control = control_[message].bytes.data();
    header.msg_controllen = control_[message].bytes.size();
    cmsghdr* cut = CMSG_FIRSTHDR(&header);
    cut->cmsg_level = SOL_UDP;
    cut->cmsg_type = UDP_SEGMENT;
    cut->cmsg_len = CMSG_LEN(sizeof(std::uint16_t));
    const auto size = static_cast<std::uint16_t>(parts_[piece.first].iov_len);
    std::memcpy(CMSG_DATA(cut), &size, sizeof size);
}

void SendBatch::mark(const Piece& piece, bool accepted) {
    std::fill_n(accepted_.begin() + static_cast<std::ptrdiff_t>(piece.first), piece.count, accepted);
}

// Up to the first joined piece that is refused: returns the datagram where that begins, else how many there are.
// A failure stops sendmmsg at the message that failed. A connected socket reports the error of an earlier datagram (port closed) once. It says nothing about this datagram, which is tried again.
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
        joins_ = joins_ && full;  // else this path or this kernel cannot
    }
    const std::size_t all = count_;
    count_ = 0;
    return {accepted_.data(), all};
}

}  // namespace thimble
