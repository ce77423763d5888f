#include "netem/relay/datagram_batch.hpp"

#include <cassert>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace thimble {
namespace {

constexpr std::size_t kRoomBytes = 65536;  // more than any UDP datagram has

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

std::size_t ReceiveBatch::receive(int descriptor) {
    for (std::size_t i = 0; i < used_; ++i) {
        messages_[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
        messages_[i].msg_hdr.msg_controllen = sizeof(Control);
    }
    int found = -1;
    do {
        found = recvmmsg(descriptor, messages_.data(), kSize, MSG_DONTWAIT, nullptr);
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
    msghdr& header = messages_[count_].msg_hdr;
    header.msg_iov = &parts_[count_];
    header.msg_iovlen = 1;
    if (to != nullptr) to_[count_] = to->generic();
    header.msg_name = to != nullptr ? &to_[count_] : nullptr;
    header.msg_namelen = to != nullptr ? sizeof(sockaddr_in) : 0;
    ++count_;
}

// A failure stops sendmmsg at the datagram that failed. An error that an earlier datagram left on a connected socket
// (nobody listens) is told once and says nothing about this one: it is tried again.
std::span<const bool> SendBatch::send(int descriptor) {
    std::size_t done = 0;
    bool again = true;
    while (done < count_) {
        const int sent = sendmmsg(descriptor, messages_.data() + done, static_cast<unsigned>(count_ - done),
                                  MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent > 0) {
            for (int i = 0; i < sent; ++i) accepted_[done++] = true;
            again = true;
        } else if (again && (errno == ECONNREFUSED || errno == EINTR)) {
            again = false;
        } else {
            accepted_[done++] = false;
            again = true;
        }
    }
    const std::size_t all = count_;
    count_ = 0;
    return {accepted_.data(), all};
}

}  // namespace thimble
