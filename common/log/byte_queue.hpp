// A queue from one thread to another. The writer never waits: entries of any length go into a ring of bytes, allocated once.
// One thread pushes, one drains. An entry that does not fit is lost and counted.
#pragma once

#include <atomic>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <memory>

#include "common/channel.hpp"

namespace thimble {

class ByteQueue {
  public:
    struct Entry {
        std::uint32_t size = 0;  // of the bytes behind it
        std::uint16_t tag = 0;   // what they are, in their writer's words
        std::int64_t time_ns = 0;
    };

    // A power of two, in bytes. All of it is touched now, so that no page is asked for later.
    explicit ByteQueue(std::size_t capacity)
        : capacity_(capacity), ring_(std::make_unique<Line[]>(capacity / sizeof(Line))) {
        assert(std::has_single_bit(capacity) && capacity >= 1024);
        std::memset(at(0), 0, capacity);
    }

    // False, and one more is lost, if there is no room.
    bool push(std::uint16_t tag, std::int64_t time_ns, Bytes bytes) {
        const std::size_t size = whole(sizeof(Entry) + bytes.size());
        const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
        // An entry stands in one piece: where the ring ends, the rest is skipped.
        const std::size_t to_end = capacity_ - offset(tail);
        const std::size_t skipped = to_end < size ? to_end : 0;
        if (!has_room(tail, size + skipped)) {
            lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
            return false;
        }
        if (skipped > 0) put(tail, {kSkip, 0, 0});
        const std::uint64_t begin = tail + skipped;
        put(begin, {static_cast<std::uint32_t>(bytes.size()), tag, time_ns});
        if (!bytes.empty()) std::memcpy(at(begin) + sizeof(Entry), bytes.data(), bytes.size());
        tail_.store(begin + size, std::memory_order_release);
        return true;
    }

    // Calls use(entry, bytes) for all that is there, in order; the bytes stand at a multiple of 8 and end with the call.
    template <class Use>
    void drain(Use&& use) {
        std::uint64_t head = head_.load(std::memory_order_relaxed);
        const std::uint64_t tail = tail_.load(std::memory_order_acquire);
        while (head != tail) {
            Entry entry{};
            std::memcpy(&entry, at(head), sizeof entry);
            if (entry.size == kSkip) {
                head += capacity_ - offset(head);
                continue;
            }
            use(entry, Bytes(at(head) + sizeof entry, entry.size));
            head += whole(sizeof entry + entry.size);
            head_.store(head, std::memory_order_release);
        }
        head_.store(head, std::memory_order_release);
    }

    std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

  private:
    struct alignas(64) Line {
        std::uint8_t bytes[64];
    };
    static constexpr std::uint32_t kSkip = UINT32_MAX;
    static_assert(sizeof(Entry) == 16, "so that there is room for one wherever an entry may begin");

    static std::size_t whole(std::size_t size) { return (size + 15) & ~std::size_t{15}; }
    std::size_t offset(std::uint64_t position) const {
        return static_cast<std::size_t>(position & (capacity_ - 1));
    }
    std::uint8_t* at(std::uint64_t position) const {
        return static_cast<std::uint8_t*>(static_cast<void*>(ring_.get())) + offset(position);
    }
    void put(std::uint64_t position, const Entry& entry) { std::memcpy(at(position), &entry, sizeof entry); }
    bool has_room(std::uint64_t tail, std::size_t size) {
        if (tail + size - known_head_ <= capacity_) return true;
        known_head_ = head_.load(std::memory_order_acquire);
        return tail + size - known_head_ <= capacity_;
    }

    std::size_t capacity_;
    std::unique_ptr<Line[]> ring_;
    alignas(64) std::atomic<std::uint64_t> tail_{0};  // of the thread that pushes, as the next two
    std::uint64_t known_head_ = 0;                    // never after head_
    std::atomic<std::uint64_t> lost_{0};
    alignas(64) std::atomic<std::uint64_t> head_{0};  // of the thread that drains
};

}  // namespace thimble
