// Datagrams by the batch: one system call for many (recvmmsg, sendmmsg). Buffers are made once.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <sys/socket.h>

#include "common/channel.hpp"
#include "common/runtime/udp_socket.hpp"

namespace thimble {

class ReceiveBatch {
  public:
    struct Datagram {
        Bytes bytes;
        UdpAddress from;
        std::int64_t stamp_realtime_ns;  // when the kernel had it; 0 if it did not say
        std::uint8_t traffic_class;      // DSCP and ECN bits
    };
    static constexpr std::size_t kSize = 32;

    ReceiveBatch();
    // Receives the waiting datagrams, at most `most` (up to kSize). ICMP errors about closed ports are skipped and
    // counted.
    std::size_t receive(int descriptor, std::size_t most = kSize);
    std::uint64_t closed_ports() const { return closed_ports_; }
    // i below what receive() returned; valid until the next receive().
    Datagram operator[](std::size_t i) const;

  private:
    struct Control {
        alignas(cmsghdr) std::array<std::uint8_t, 128> bytes;
    };
    std::unique_ptr<std::uint8_t[]> data_;
    std::array<mmsghdr, kSize> messages_{};
    std::array<iovec, kSize> parts_{};
    std::array<SocketAddress, kSize> from_{};
    std::array<Control, kSize> control_{};
    std::size_t used_ = kSize;  // entries that the kernel has shortened
    std::uint64_t closed_ports_ = 0;
};

// How many datagrams to ask a socket for. To look in vain for one more costs the kernel a good part of what a datagram
// costs. So a socket that is asked whenever it has something is asked for one, and for more when there are.
class ReceiveTurn {
  public:
    std::size_t most() const { return most_; }
    // The result. Less than half: half as many the next time. All, so often in a row: twice as many.
    void got(std::size_t count) {
        full_ = count == most_ ? full_ + 1 : 0;
        if (full_ == kOften) {
            most_ = std::min(2 * most_, ReceiveBatch::kSize);
            full_ = 0;
        } else if (2 * count <= most_) {
            most_ = std::max<std::size_t>(1, most_ / 2);
        }
    }

  private:
    static constexpr unsigned kOften = 8;
    std::size_t most_ = 1;
    unsigned full_ = 0;
};

class SendBatch {
  public:
    static constexpr std::size_t kSize = 64;
    // Least number of consecutive datagrams of one size to one receiver that are passed to the kernel as one piece.
    // The kernel splits it at the end of its own path (UDP_SEGMENT), which costs far less. Shorter runs stay single,
    // because captures and queue disciplines on the path would see the piece as one packet.
    static constexpr std::size_t kJoin = 16;
    static constexpr std::size_t kLongestJoined = 1200;  // bytes; a cut must fit every path

    // `joins`: allows joining datagrams.
    explicit SendBatch(bool joins = false) : joins_(joins) {}

    // `to` is left out for a connected socket, which is of the peer's family. The bytes must stay until send().
    void add(Bytes bytes, const UdpAddress* to, std::uint8_t traffic_class = 0, bool ipv4 = true);
    // Joins from now on, if this path can.
    void join(bool joins) { joins_ = joins && !cannot_join_; }
    std::uint64_t closed_ports() const { return closed_ports_; }  // as in ReceiveBatch
    bool full() const { return count_ == kSize; }
    std::size_t size() const { return count_; }
    // Sends all through one socket and empties the batch. accepted[i] says whether the kernel took datagram i.
    std::span<const bool> send(int descriptor);

  private:
    struct Control {
        alignas(cmsghdr)
            std::array<std::uint8_t, CMSG_SPACE(sizeof(std::uint16_t)) + CMSG_SPACE(sizeof(int))> bytes;
    };
    struct Piece {
        std::size_t first, count;  // datagrams
    };

    std::size_t same_from(std::size_t first) const;
    std::size_t gather(std::size_t first, bool joins);
    void fill(std::size_t message, const Piece& piece);
    template <class Value>
    void put(std::size_t message, int level, int type, Value value);
    std::size_t send_pieces(int descriptor, std::size_t pieces);
    void mark(const Piece& piece, bool accepted);

    bool joins_;
    bool cannot_join_ = false;
    std::uint64_t closed_ports_ = 0;
    std::array<mmsghdr, kSize> messages_{};
    std::array<iovec, kSize> parts_{};
    std::array<SocketAddress, kSize> to_{};
    std::array<bool, kSize> addressed_{}, ipv4_{};
    std::array<std::uint8_t, kSize> traffic_class_{};
    std::array<Control, kSize> control_{};
    std::array<Piece, kSize> pieces_{};
    std::array<bool, kSize> accepted_{};
    std::size_t count_ = 0;
};

}  // namespace thimble
