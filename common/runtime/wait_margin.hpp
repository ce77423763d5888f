// How long before a deadline a sleeper must wake so that the timer's own lateness does not matter, learnt from what
// the timer did lately; and how much spinning the machine can bear. Pure arithmetic.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/time.hpp"

namespace thimble {

class WaitMargin {
  public:
    // How late a timer fired.
    void add(Duration lateness) {
        const std::int64_t us = std::max<std::int64_t>(0, (lateness.count() + 999) / 1000);
        if (us >= kLimit_us) return;
        if (filled_ == kSamples) {
            --count_[recent_us_[next_]];
        } else {
            ++filled_;
        }
        recent_us_[next_] = static_cast<std::uint8_t>(us);
        ++count_[static_cast<std::size_t>(us)];
        next_ = (next_ + 1) % kSamples;
        if (next_ % kRefresh == 0) refresh();
    }

    // Covers all but the two worst of the last 512, rounded up to a whole microsecond. Latenesses of 200 us and more
    // are stalls of the machine, which no margin buys back: they do not count.
    Duration margin() const { return std::chrono::microseconds{margin_us_}; }

  private:
    static constexpr unsigned kLeftOut = 2;  // the worst of the list
    static constexpr unsigned kLeast_us = 2, kLimit_us = 200;
    static constexpr std::size_t kSamples = 512;
    static constexpr std::size_t kRefresh = 16;  // samples between two looks at the list

    void refresh() {
        unsigned above = 0;
        unsigned us = kLimit_us;
        while (us > 0 && above + count_[us - 1] <= kLeftOut) above += count_[--us];
        margin_us_ = std::max(us > 0 ? us - 1 : 0, kLeast_us);
    }

    std::array<std::uint8_t, kSamples> recent_us_{};
    std::array<std::uint16_t, kLimit_us> count_{};
    std::size_t filled_ = 0, next_ = 0;
    unsigned margin_us_ = 100;  // until the timer is known
};

// At most 80 % of any 100 ms, so that real-time throttling never strikes and the core's other work goes on.
class SpinBudget {
  public:
    void spent(SessionTime until, Duration duration) {
        advance(until);
        spun_ns_[static_cast<std::size_t>(slice_ % kSlices)] += duration.count();
        sum_ns_ += duration.count();
    }

    // The time that a thread may still spin from `now` on; zero or less: sleep.
    Duration left(SessionTime now) {
        advance(now);
        return Duration{kAllowed_ns - sum_ns_};
    }

  private:
    static constexpr std::int64_t kAllowed_ns = 80'000'000;
    static constexpr std::int64_t kSlice_ns = 10'000'000;
    static constexpr std::size_t kSlices = 11;  // those that touch the last 100 ms

    void advance(SessionTime now) {
        const std::int64_t slice = to_nanoseconds(now) / kSlice_ns;
        const std::int64_t passed = std::min<std::int64_t>(slice - slice_, kSlices);
        for (std::int64_t i = 1; i <= passed; ++i) {
            std::int64_t& oldest = spun_ns_[static_cast<std::size_t>((slice - passed + i) % kSlices)];
            sum_ns_ -= oldest;
            oldest = 0;
        }
        slice_ = std::max(slice_, slice);
    }

    std::array<std::int64_t, kSlices> spun_ns_{};
    std::int64_t slice_ = 0;
    std::int64_t sum_ns_ = 0;
};

}  // namespace thimble
