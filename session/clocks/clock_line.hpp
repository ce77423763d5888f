// Offset and rate of one clock against another over a whole stretch, if both ran evenly: every straight line
// offset(t) = a + b t, |b| <= kClockRateLimit, that stays below each exchange's upper bound and above each lower one is
// possible, no other is.
// Least and greatest b, and the least and greatest value at any time, are exact: the bounds that matter are the corners
// of two convex hulls, and eliminating a leaves one inequality in b per pair of them (Fourier-Motzkin). Linear
// programming on delays: Moon, Skelly and Towsley 1999; hulls: Zhang, Liu and Xia 2002.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "session/clocks/clock_prober.hpp"

namespace thimble {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// The greatest value of a concave function on [low, high].
template <class Function>
double greatest(double low, double high, Function&& value) {
    for (int i = 0; i < 200 && low < high; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (value(a) < value(b) ? low : high) = value(a) < value(b) ? a : b;
    }
    return value((low + high) / 2);
}

class ClockLine {
  public:
    // Exchanges in any order. None if no line passes through them all: a clock stepped, or its rate wandered.
    static std::optional<ClockLine> fit(std::span<const ClockExchange> exchanges) {
        if (exchanges.empty()) return std::nullopt;
        ClockLine line;
        line.start_ = exchanges.front().sent;
        line.base_ = exchanges.front().high();
        std::vector<Corner> above, below;
        for (const ClockExchange& e : exchanges) {
            above.push_back({to_seconds(e.sent - line.start_), to_seconds(e.high() - line.base_)});
            below.push_back({to_seconds(e.answered - line.start_), to_seconds(e.low() - line.base_)});
        }
        line.above_ = hull(std::move(above), 1);
        line.below_ = hull(std::move(below), -1);
        line.rate_low_ = -kClockRateLimit;
        line.rate_high_ = kClockRateLimit;
        for (const Corner& low : line.below_) {
            for (const Corner& high : line.above_) {
                const double room_s = high.offset_s - low.offset_s, apart_s = high.time_s - low.time_s;
                if (apart_s > 0) line.rate_high_ = std::min(line.rate_high_, room_s / apart_s);
                if (apart_s < 0) line.rate_low_ = std::max(line.rate_low_, room_s / apart_s);
                if (apart_s == 0 && room_s < 0) return std::nullopt;
            }
        }
        if (line.rate_low_ > line.rate_high_) return std::nullopt;
        return line;
    }

    // Seconds gained by the far clock per second of the near one; +-kClockRateLimit where the exchanges say nothing.
    double rate_low() const { return rate_low_; }
    double rate_high() const { return rate_high_; }
    // `near` on the near clock.
    OffsetInterval at(SessionTime near) const {
        const double time_s = to_seconds(near - start_), base_s = to_seconds(base_);
        const double highest_s =
            greatest(rate_low_, rate_high_, [&](double rate) { return highest_at(time_s, rate); });
        const double lowest_s =
            -greatest(rate_low_, rate_high_, [&](double rate) { return -lowest_at(time_s, rate); });
        return {base_s + lowest_s, base_s + highest_s};
    }

  private:
    // Both counted from the first exchange, in seconds, so that no digits are lost to the time since boot.
    struct Corner {
        double time_s, offset_s;
    };
    // Positive if a, b, c turn to the left.
    static double turn(const Corner& a, const Corner& b, const Corner& c) {
        return (b.time_s - a.time_s) * (c.offset_s - a.offset_s) -
               (b.offset_s - a.offset_s) * (c.time_s - a.time_s);
    }

    // The corners that a line below (side 1) or above (side -1) all of them can touch: half of the convex hull
    // (Andrew's monotone chain).
    static std::vector<Corner> hull(std::vector<Corner> corners, double side) {
        std::sort(corners.begin(), corners.end(), [&](const Corner& a, const Corner& b) {
            return a.time_s != b.time_s ? a.time_s < b.time_s : side * a.offset_s < side * b.offset_s;
        });
        std::vector<Corner> chain;
        for (const Corner& corner : corners) {
            if (!chain.empty() && chain.back().time_s == corner.time_s) continue;  // the tighter one is there
            while (chain.size() > 1 && side * turn(chain[chain.size() - 2], chain.back(), corner) <= 0) {
                chain.pop_back();
            }
            chain.push_back(corner);
        }
        return chain;
    }

    double highest_at(double time_s, double rate) const {
        double highest_s = kUnbounded;
        for (const Corner& c : above_)
            highest_s = std::min(highest_s, c.offset_s + rate * (time_s - c.time_s));
        return highest_s;
    }

    double lowest_at(double time_s, double rate) const {
        double lowest_s = -kUnbounded;
        for (const Corner& c : below_) lowest_s = std::max(lowest_s, c.offset_s + rate * (time_s - c.time_s));
        return lowest_s;
    }

    SessionTime start_{};
    Duration base_{};  // offset that the corners count from
    std::vector<Corner> above_, below_;
    double rate_low_ = 0, rate_high_ = 0;
};

}  // namespace thimble
