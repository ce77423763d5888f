// A queue between exactly two threads, one that pushes and one that pops. Neither ever waits, so the node's real-time thread
// may use it beside a window that hangs.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

namespace thimble {

template <class T>
class SpscRing {
  public:
    explicit SpscRing(std::size_t capacity) : slots_(capacity + 1) {}

    // False: full, nothing was pushed.
    bool push(const T& value) {
        const std::size_t end = end_.load(std::memory_order_relaxed);
        const std::size_t next = after(end);
        if (next == begin_.load(std::memory_order_acquire)) return false;
        slots_[end] = value;
        end_.store(next, std::memory_order_release);
        return true;
    }
    // The oldest, null if there is none; valid until pop().
    const T* front() const {
        const std::size_t begin = begin_.load(std::memory_order_relaxed);
        return begin == end_.load(std::memory_order_acquire) ? nullptr : &slots_[begin];
    }
    // Only after front() gave something.
    void pop() { begin_.store(after(begin_.load(std::memory_order_relaxed)), std::memory_order_release); }

  private:
    std::size_t after(std::size_t i) const { return i + 1 == slots_.size() ? 0 : i + 1; }

    std::vector<T> slots_;  // one stays empty: full and empty must differ
    std::atomic<std::size_t> begin_{0}, end_{0};
};

}  // namespace thimble
