// The offset of a clock now, from the exchanges of the last few seconds: the intersection of their intervals, each
// widened by what the clocks may have moved against each other since. An intersection that is empty says that a clock
// was set, or its machine stopped: counted, and the window begins anew. A step smaller than the bounds goes unseen, and
// does not make them wrong by more than itself until it has left the window.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "session/clocks/clock_exchange.hpp"

namespace thimble {

// Greatest rate of two clocks against each other. Linux slews each by at most 500 parts per million (adjtimex(2)).
inline constexpr double kClockRateLimit = 1e-3;

class ClockFilter {
  public:
    // True if it fits the window; false if a clock has stepped.
    bool add(const ClockExchange& exchange);
    // `now` on the near clock, not before the last exchange. None before the first one.
    std::optional<OffsetInterval> at(SessionTime now) const;

    std::uint64_t exchanges() const { return exchanges_; }
    std::uint64_t steps() const { return steps_; }

  private:
    OffsetInterval intersection(SessionTime now) const;
    void remember(const ClockExchange& exchange);

    std::array<ClockExchange, 64> window_{};
    std::size_t size_ = 0, next_ = 0;
    std::uint64_t exchanges_ = 0, steps_ = 0;
};

}  // namespace thimble
