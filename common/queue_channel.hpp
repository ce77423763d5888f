// A channel for virtual time: datagrams arrive the moment they are sent. Delay is the LinkModel's business.
#pragma once

#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <memory>

#include "common/channel.hpp"
#include "common/shared_message.hpp"

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
    // From now on messages of this pool are handed over; the other end must have the same.
    void share(MessagePool& pool) { pool_ = &pool; }
    // Each arrival sets `bit` in `*mask`, so that a loop knows whom to wake.
    void wake(std::uint32_t* mask, std::uint32_t bit) {
        mask_ = mask;
        bit_ = bit;
    }

    void send(Bytes datagram) override {
        if (peer_ != nullptr) peer_->deliver(datagram);
    }
    void hand_over(SharedMessage& message) override {
        if (peer_ != nullptr) peer_->deliver(message);
    }

    std::uint64_t lost() const { return lost_; }

  private:
    struct alignas(16) Slot {
        SharedMessage* shared;  // instead of bytes
        std::uint32_t size;
        alignas(16) std::uint8_t bytes[kMaxDatagramBytes];
    };
    Slot& slot(std::uint64_t place) { return slots_[place & (capacity_ - 1)]; }

    Bytes take() override {
        Slot& taken = take_slot();
        if (taken.shared != nullptr) put(taken, pool_->bytes_of(*taken.shared));
        return {taken.bytes, taken.size};
    }
    SharedMessage* take_shared() override { return take_slot().shared; }

    // A message is kept until the next one is taken.
    Slot& take_slot() {
        if (kept_ != nullptr) pool_->release(*kept_);
        Slot& taken = slot(head_++);
        kept_ = taken.shared;
        known_empty_ = head_ == tail_;
        shared_waits_ = !known_empty_ && slot(head_).shared != nullptr;
        return taken;
    }

    static void put(Slot& slot, Bytes datagram) {
        slot.size = static_cast<std::uint32_t>(datagram.size());
        std::memcpy(slot.bytes, datagram.data(), datagram.size());
    }

    void deliver(Bytes datagram) {
        Slot* free = datagram.size() > kMaxDatagramBytes ? nullptr : free_slot();
        if (free == nullptr) {
            ++lost_;
            return;
        }
        free->shared = nullptr;
        put(*free, datagram);
        arrived();
    }
    void deliver(SharedMessage& message) {
        Slot* free = free_slot();
        if (free == nullptr) {
            ++lost_;
            return;
        }
        free->shared = &message;
        ++message.users;
        arrived();
    }

    Slot* free_slot() {
        // A channel that is drained at once uses one slot, always in the cache.
        if (released_) head_ = tail_ = 0;
        // One slot stays free: it is the one a receiver may still be reading.
        return tail_ - head_ + 1 >= capacity_ ? nullptr : &slot(tail_);
    }
    void arrived() {
        ++tail_;
        shared_waits_ = slot(head_).shared != nullptr;
        known_empty_ = released_ = false;
        if (mask_ != nullptr) *mask_ |= bit_;
    }

    std::size_t capacity_;
    std::unique_ptr<Slot[]> slots_;
    std::uint64_t head_ = 0, tail_ = 0;  // next to receive, next to fill
    std::uint64_t lost_ = 0;
    QueueChannel* peer_ = nullptr;
    SharedMessage* kept_ = nullptr;
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
