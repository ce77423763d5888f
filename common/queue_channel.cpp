#include "common/queue_channel.hpp"

#include <bit>
#include <cassert>
#include <cstring>

namespace thimble {

QueueChannel::QueueChannel(std::size_t capacity)
    : capacity_(capacity), slots_(std::make_unique_for_overwrite<Slot[]>(capacity)) {
    assert(std::has_single_bit(capacity) && capacity > 1);
    known_empty_ = true;
}

void QueueChannel::send(Bytes datagram) {
    if (peer_ != nullptr) peer_->deliver(datagram);
}

void QueueChannel::deliver(Bytes datagram) {
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

Bytes QueueChannel::take() {
    const Slot& slot = slots_[head_++ & (capacity_ - 1)];
    known_empty_ = head_ == tail_;
    return {slot.bytes, slot.size};
}

}  // namespace thimble
