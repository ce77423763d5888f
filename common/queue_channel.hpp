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
    explicit QueueChannel(std::size_t capacity = 64)
        : last_(capacity - 1), shared_(new SharedMessage*[capacity]), slots_(new Slot[capacity]) {
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
        std::uint32_t size;
        alignas(16) std::uint8_t bytes[kMaxDatagramBytes];
    };
    SharedMessage*& shared(std::uint64_t place) { return shared_[place & last_]; }
    Slot& slot(std::uint64_t place) { return slots_[place & last_]; }

    Bytes take() override {
        Slot& taken = slot(head_);
        if (SharedMessage* const message = take_place()) put(taken, pool_->bytes_of(*message));
        return {taken.bytes, taken.size};
    }
    SharedMessage* take_shared() override { return take_place(); }

    // A message is kept until the next one is taken. Null: bytes are in the slot.
    SharedMessage* take_place() {
        if (kept_ != nullptr) pool_->release(*kept_);
        kept_ = shared(head_++);
        known_empty_ = head_ == tail_;
        shared_waits_ = !known_empty_ && shared(head_) != nullptr;
        return kept_;
    }

    static void put(Slot& slot, Bytes datagram) {
        slot.size = static_cast<std::uint32_t>(datagram.size());
        std::memcpy(slot.bytes, datagram.data(), datagram.size());
    }

    void deliver(Bytes datagram) {
        if (datagram.size() > kMaxDatagramBytes || !has_room()) {
            ++lost_;
            return;
        }
        put(slot(tail_), datagram);
        arrived(nullptr);
    }
    void deliver(SharedMessage& message) {
        if (!has_room()) {
            ++lost_;
            return;
        }
        ++message.users;
        arrived(&message);
    }

    bool has_room() {
        // A channel that is drained at once uses one slot, always in the cache.
        if (released_) head_ = tail_ = 0;
        // One slot stays free: a receiver may still be reading it.
        return tail_ - head_ < last_;
    }
    void arrived(SharedMessage* message) {
        shared(tail_++) = message;
        if (known_empty_) shared_waits_ = message != nullptr;
        known_empty_ = released_ = false;
        if (mask_ != nullptr) *mask_ |= bit_;
    }

    std::uint64_t last_;                        // place; the capacity is a power of two
    std::unique_ptr<SharedMessage*[]> shared_;  // null: bytes in the slot of this place
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
