// The lead time before a packet's due time at which sending may begin. Handling and the system call take at least
// this long, so the packet does not leave early.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "common/time.hpp"

namespace thimble {

// The least of the last 64 to 128 durations; zero until there are so many. Pure arithmetic.
class LeastLately {
  public:
    void add(Duration took) {
        least_ = std::min(least_, took);
        known_ = std::min(known_, took);
        if (++count_ < kGeneration) return;
        known_ = std::min(before_, least_);
        before_ = std::exchange(least_, Duration::max());
        count_ = 0;
    }
    Duration least() const { return known_; }

  private:
    static constexpr std::size_t kGeneration = 64;
    Duration least_ = Duration::max(), before_ = Duration::max(), known_{};
    std::size_t count_ = 0;
};

// From before a call that sends one datagram to the kernel's stamp at the receiver, on the shortest path there is: the least over
// loopback, from calls in a row, less half a microsecond for what readings of clocks are worth. Takes about 10 ms.
// Zero where it cannot be measured, e.g. without loopback.
Duration measure_send_cost();

}  // namespace thimble
