// A message on its way within one program: one struct for all who wait for it, and bytes only for those who need them. Virtual time
// sends so: to encode, check and decode each message anew took a third of its time. Not for several threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/codec.hpp"

namespace thimble {

// The numbers of `message` are in range: decoding its bytes gives the same struct. None shares a cache line with another.
struct alignas(64) SharedMessage {
    Message message;
    std::uint32_t users = 0;  // who may still look at it
    SharedMessage* next_free = nullptr;
};

// Outlives all channels that hand over its messages. It keeps its memory until its end, so a user that never releases costs no
// more than that memory.
class MessagePool : boost::noncopyable {
  public:
    // A free message, with the caller as its only user.
    SharedMessage& take() {
        if (free_ == nullptr) grow();
        SharedMessage& taken = *free_;
        free_ = taken.next_free;
        taken.users = 1;
        return taken;
    }
    void release(SharedMessage& message) {
        if (--message.users > 0) return;
        message.next_free = free_;
        free_ = &message;
    }
    // As the sender's encoder would have made them; valid until the next call.
    Bytes bytes_of(const SharedMessage& message) { return encoder_.encode(message.message); }
    std::size_t size() const { return size_; }

  private:
    // Doubles the pool; never once a session is under way.
    void grow() {
        const std::size_t count = std::max<std::size_t>(size_, 64);
        chunks_.push_back(std::make_unique<SharedMessage[]>(count));
        for (std::size_t i = count; i-- > 0; free_ = &chunks_.back()[i]) chunks_.back()[i].next_free = free_;
        size_ += count;
    }

    std::vector<std::unique_ptr<SharedMessage[]>> chunks_;
    std::size_t size_ = 0;
    SharedMessage* free_ = nullptr;
    Encoder encoder_;
};

}  // namespace thimble
