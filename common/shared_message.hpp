// A message on its way within one program: one struct for all who wait for it, and bytes only for those who need them. Virtual time
// sends so: to encode, check and decode each message anew took a third of its time. Not for several threads.
#pragma once

#include <cstdint>
#include <deque>

#include <boost/core/noncopyable.hpp>

#include "common/codec.hpp"

namespace thimble {

// The numbers of `message` are in range: decoding its bytes gives the same struct.
struct SharedMessage {
    Message message;
    std::uint32_t users = 0;  // who may still look at it
    SharedMessage* next_free = nullptr;
};

// Outlives all channels that hand over its messages. It keeps its memory until its end, so a user that never releases costs no
// more than that memory.
class MessagePool : boost::noncopyable {
  public:
    // Any message, with the caller as its user.
    SharedMessage& take() {
        SharedMessage* taken = free_;
        if (taken == nullptr) {
            taken = &made_.emplace_back();
        } else {
            free_ = taken->next_free;
        }
        taken->users = 1;
        return *taken;
    }
    void release(SharedMessage& message) {
        if (--message.users > 0) return;
        message.next_free = free_;
        free_ = &message;
    }
    // As the sender's encoder would have made them; valid until the next call.
    Bytes bytes_of(const SharedMessage& message) { return encoder_.encode(message.message); }
    std::size_t size() const { return made_.size(); }  // the most that were ever under way

  private:
    std::deque<SharedMessage> made_;
    SharedMessage* free_ = nullptr;
    Encoder encoder_;
};

}  // namespace thimble
