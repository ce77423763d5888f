// Datagrams by the batch: one system call for many (recvmmsg, sendmmsg). Buffers are made once.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <sys/socket.h>
#include <vector>

#include "common/channel.hpp"
#include "common/runtime/stamp_clock.hpp"
#include "netem/relay/udp_address.hpp"

namespace thimble {

class ReceiveBatch {
  public:
    struct Datagram {
        Bytes bytes;
        UdpAddress from;
        std::int64_t stamp_realtime_ns;  // when the kernel had it; 0 if it did not say
    };
    static constexpr std::size_t kSize = 32;

    ReceiveBatch();
    // As many as wait, at most `most` (up to kSize). Errors of an earlier send (port closed) are passed over.
    std::size_t receive(int descriptor, std::size_t most = kSize);
    // i below what receive() returned; valid until the next receive().
    Datagram operator[](std::size_t i) const;

  private:
    struct Control {
        alignas(cmsghdr) std::array<std::uint8_t, 64> bytes;
    };
    std::unique_ptr<std::uint8_t[]> data_;
    std::array<mmsghdr, kSize> messages_{};
    std::array<iovec, kSize> parts_{};
    std::array<sockaddr_in, kSize> from_{};
    std::array<Control, kSize> control_{};
    std::size_t used_ = kSize;  // entries that the kernel has shortened
};

class SendBatch {
  public:
    static constexpr std::size_t kSize = 64;
    // So many datagrams of one size to one receiver, in a row, are handed over as one piece that the kernel cuts up at the far end of
    // its own path (UDP_SEGMENT): that costs it far less, and what arrives is the same. Fewer stay single, because whatever watches the path
    // (a packet capture, a queue discipline that drops) sees the piece.
    static constexpr std::size_t kJoin = 16;
    static constexpr std::size_t kLongestJoined = 1200;  // bytes; a cut must fit every path

    // `joins`: whether it ever does that.
    explicit SendBatch(bool joins = false) : joins_(joins) {}

    // `to` is left out for a connected socket. The bytes must stay until send().
    void add(Bytes bytes, const UdpAddress* to);
    bool full() const { return count_ == kSize; }
    std::size_t size() const { return count_; }
    // Sends all through one socket and empties the batch. accepted[i] says whether the kernel took datagram i.
    std::span<const bool> send(int descriptor);

  private:
    struct Control {
        alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(std::uint16_t))> bytes;
    };
    struct Piece {
        std::size_t first, count;  // datagrams
    };

    std::size_t same_from(std::size_t first) const;
    std::size_t gather(std::size_t first, bool joins);
    void fill(std::size_t message, const Piece& piece);
    std::size_t send_pieces(int descriptor, std::size_t pieces);
    void mark(const Piece& piece, bool accepted);

    bool joins_;
    std::array<mmsghdr, kSize> messages_{};
    std::array<iovec, kSize> parts_{};
    std::array<sockaddr_in, kSize> to_{};
    std::array<bool, kSize> addressed_{};
    std::array<Control, kSize> control_{};
    std::array<Piece, kSize> pieces_{};
    std::array<bool, kSize> accepted_{};
    std::size_t count_ = 0;
};

}  // namespace thimble
