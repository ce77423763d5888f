// A channel for virtual time: datagrams arrive the moment they are sent. Delay is the LinkModel's business.
#pragma once

#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <memory>

#include "common/channel.hpp"

namespace thimble {

class QueueChannel final : public Channel {
  public:
    // `capacity` datagrams wait at most; one more is lost and counted. A power of two.
    explicit QueueChannel(std::size_t capacity = 64) : capacity_(capacity), slots_(new Slot[capacity]) {
        assert(std::has_single_bit(capacity) && capacity > 1);
        known_empty_ = true;
    }

    // `peer` receives the datagrams that this end sends.
    void connect(QueueChannel& peer) { peer_ = &peer; }
    // Each arrival sets `bit` in `*mask`, so that a loop knows whom to wake.
    void wake(std::uint32_t* mask, std::uint32_t bit) {
        mask_ = mask;
        bit_ = bit;
    }

    void send(Bytes datagram) override {
        if (peer_ != nullptr) peer_->deliver(datagram);
    }

    std::uint64_t lost() const { return lost_; }

  private:
    struct alignas(16) Slot {
        std::uint32_t size;
        alignas(16) std::uint8_t bytes[kMaxDatagramBytes];
    };
    Bytes take() override {
        const Slot& slot = slots_[head_++ & (capacity_ - 1)];
        known_empty_ = head_ == tail_;
        return {slot.bytes, slot.size};
    }

    void deliver(Bytes datagram) {
        // A channel that is drained at once uses one slot, always in the cache.
        if (released_) head_ = tail_ = 0;
        // One slot stays free: it is the one a receiver may still be reading.
        if (datagram.size() > kMaxDatagramBytes || tail_ - head_ + 1 >= capacity_) {
            ++lost_;
            return;
        }
        Slot& slot = slots_[tail_++ & (capacity_ - 1)];
        slot.size = static_cast<std::uint32_t>(datagram.size());
        std::memcpy(slot.bytes, datagram.data(), datagram.size());
        known_empty_ = released_ = false;
        if (mask_ != nullptr) *mask_ |= bit_;
    }

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
