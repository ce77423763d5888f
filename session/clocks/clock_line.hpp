// Offset and rate of one clock against another over a whole stretch, if both ran evenly: every straight line
// offset(t) = a + b t, |b| <= kClockRateLimit, that stays below each exchange's upper bound and above each lower one is
// possible, no other is.
// Least and greatest b, and the least and greatest value at any time, are exact: the bounds that matter are the corners
// of two convex hulls, and eliminating a leaves one inequality in b per pair of them (Fourier-Motzkin). Linear
// programming on delays: Moon, Skelly and Towsley 1999; hulls: Zhang, Liu and Xia 2002.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "session/clocks/clock_prober.hpp"

namespace thimble {

class ClockLine {
  public:
    // Exchanges in any order. None if no line passes through them all: a clock stepped, or its rate wandered.
    static std::optional<ClockLine> fit(std::span<const ClockExchange> exchanges);

    // Seconds gained by the far clock per second of the near one; +-kClockRateLimit where the exchanges say nothing.
    double rate_low() const { return rate_low_; }
    double rate_high() const { return rate_high_; }
    // `near` on the near clock.
    OffsetInterval at(SessionTime near) const;

  private:
    // Both counted from the first exchange, in seconds, so that no digits are lost to the time since boot.
    struct Corner {
        double time_s, offset_s;
    };
    static double turn(const Corner& a, const Corner& b, const Corner& c);
    static std::vector<Corner> hull(std::vector<Corner> corners, double side);
    double highest_at(double time_s, double rate) const;
    double lowest_at(double time_s, double rate) const;

    SessionTime start_{};
    Duration base_{};  // offset that the corners count from
    std::vector<Corner> above_, below_;
    double rate_low_ = 0, rate_high_ = 0;
};

}  // namespace thimble
