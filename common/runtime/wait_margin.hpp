// How long before a deadline a sleeper must wake so that the timer's own lateness does not matter, learnt from what
// the timer did lately; and how much spinning the machine can bear. Pure arithmetic.
#pragma once

#include <array>
#include <cstdint>

#include "common/time.hpp"

namespace thimble {

class WaitMargin {
  public:
    // How late a timer fired.
    void add(Duration lateness);
    // Covers all but the two worst of the last 512, rounded up to a whole microsecond. Latenesses of 200 us and more
    // are stalls of the machine, which no margin buys back: they do not count.
    Duration margin() const { return std::chrono::microseconds{margin_us_}; }

  private:
    static constexpr unsigned kLimit_us = 200;
    static constexpr std::size_t kSamples = 512;
    static constexpr std::size_t kRefresh = 16;  // samples between two looks at the list

    void refresh();

    std::array<std::uint8_t, kSamples> recent_us_{};
    std::array<std::uint16_t, kLimit_us> count_{};
    std::size_t filled_ = 0, next_ = 0;
    unsigned margin_us_ = 100;  // until the timer is known
};

// At most 80 % of any 100 ms, so that real-time throttling never strikes and the core's other work goes on.
class SpinBudget {
  public:
    void spent(SessionTime until, Duration duration);
    // The time that a thread may still spin from `now` on; zero or less: sleep.
    Duration left(SessionTime now);

  private:
    static constexpr std::int64_t kSlice_ns = 10'000'000;
    static constexpr std::size_t kSlices = 11;  // those that touch the last 100 ms

    void advance(SessionTime now);

    std::array<std::int64_t, kSlices> spun_ns_{};
    std::int64_t slice_ = 0;
    std::int64_t sum_ns_ = 0;
};

}  // namespace thimble
