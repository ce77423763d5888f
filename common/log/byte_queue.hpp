// A queue from one thread to another. The writer never waits and never allocates: an entry that does not fit is lost and counted.
// One thread pushes, one drains.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <vector>

#include <boost/lockfree/spsc_queue.hpp>

#include "common/channel.hpp"

namespace thimble {

class ByteQueue {
  public:
    struct Entry {
        std::uint32_t size = 0;  // of the bytes behind it, at most kMaxDatagramBytes
        std::uint16_t tag = 0;   // what they are, in their writer's words
        std::int64_t time_ns = 0;
    };

    // In bytes. All of it is touched now, so that no page is asked for later.
    explicit ByteQueue(std::size_t capacity) : ring_(capacity) {
        const std::vector<std::uint8_t> zeros(capacity);
        ring_.push(zeros.data(), zeros.size());
        ring_.reset();
    }

    // False, and one more is lost, if there is no room.
    bool push(std::uint16_t tag, std::int64_t time_ns, Bytes bytes) {
        assert(bytes.size() <= kMaxDatagramBytes);
        Whole whole;  // in one piece, because the other thread may read at any moment
        const Entry entry{static_cast<std::uint32_t>(bytes.size()), tag, time_ns};
        std::memcpy(whole.data(), &entry, sizeof entry);
        std::copy(bytes.begin(), bytes.end(), whole.begin() + sizeof entry);
        const std::size_t size = sizeof entry + bytes.size();
        const bool fits = ring_.write_available() >= size;
        if (fits) ring_.push(whole.data(), size);
        if (!fits) lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return fits;
    }

    // Calls use(entry, bytes) for all that is there, in order; the bytes stand at a multiple of 8 and end with the call.
    template <class Use>
    void drain(Use&& use) {
        alignas(16) Whole whole;
        Entry entry;
        for (std::size_t left = ring_.read_available(); left > 0; left -= sizeof entry + entry.size) {
            ring_.pop(whole.data(), sizeof entry);
            std::memcpy(&entry, whole.data(), sizeof entry);
            ring_.pop(whole.data(), entry.size);
            use(entry, Bytes(whole.data(), entry.size));
        }
    }

    std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

  private:
    using Whole = std::array<std::uint8_t, sizeof(Entry) + kMaxDatagramBytes>;

    boost::lockfree::spsc_queue<std::uint8_t> ring_;
    std::atomic<std::uint64_t> lost_{0};
};

}  // namespace thimble
