// A channel for virtual time: datagrams arrive the moment they are sent. Delay is the LinkModel's business.
#pragma once

#include <cstdint>
#include <memory>

#include "common/channel.hpp"

namespace thimble {

class QueueChannel final : public Channel {
  public:
    // `capacity` datagrams wait at most; one more is lost and counted. A power of two.
    explicit QueueChannel(std::size_t capacity = 64);

    // `peer` receives the datagrams that this end sends.
    void connect(QueueChannel& peer) { peer_ = &peer; }
    // Each arrival sets `bit` in `*mask`, so that a loop knows whom to wake.
    void wake(std::uint32_t* mask, std::uint32_t bit) {
        mask_ = mask;
        bit_ = bit;
    }

    void send(Bytes datagram) override;

    std::uint64_t lost() const { return lost_; }

  private:
    struct alignas(16) Slot {
        std::uint32_t size;
        alignas(16) std::uint8_t bytes[kMaxDatagramBytes];
    };
    Bytes take() override;
    void deliver(Bytes datagram);

    std::size_t capacity_;
    std::unique_ptr<Slot[]> slots_;
    std::uint64_t head_ = 0, tail_ = 0;  // next to receive, next to fill
    std::uint64_t lost_ = 0;
    QueueChannel* peer_ = nullptr;
    std::uint32_t* mask_ = nullptr;
    std::uint32_t bit_ = 0;
};

// Two channels that are each other's other end; each arrival at an end wakes its owner.
struct QueuePipe {
    QueueChannel a, b;
    QueuePipe() {
        a.connect(b);
        b.connect(a);
    }
};

}  // namespace thimble
