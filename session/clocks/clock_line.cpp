#include "session/clocks/clock_line.hpp"

#include <algorithm>
#include <limits>

namespace thimble {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// The greatest value of a concave function on [low, high].
template <class Function>
double greatest(double low, double high, Function&& value) {
    for (int i = 0; i < 200 && low < high; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (value(a) < value(b) ? low : high) = value(a) < value(b) ? a : b;
    }
    return value((low + high) / 2);
}

}  // namespace

// Positive if a, b, c turn to the left.
double ClockLine::turn(const Corner& a, const Corner& b, const Corner& c) {
    return (b.time_s - a.time_s) * (c.offset_s - a.offset_s) -
           (b.offset_s - a.offset_s) * (c.time_s - a.time_s);
}

// The chain that a line below (side 1) or above (side -1) all corners can touch (Andrew's monotone chain).
std::vector<ClockLine::Corner> ClockLine::hull(std::vector<Corner> corners, double side) {
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

std::optional<ClockLine> ClockLine::fit(std::span<const ClockExchange> exchanges) {
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

double ClockLine::highest_at(double time_s, double rate) const {
    double highest_s = kUnbounded;
    for (const Corner& c : above_) highest_s = std::min(highest_s, c.offset_s + rate * (time_s - c.time_s));
    return highest_s;
}

double ClockLine::lowest_at(double time_s, double rate) const {
    double lowest_s = -kUnbounded;
    for (const Corner& c : below_) lowest_s = std::max(lowest_s, c.offset_s + rate * (time_s - c.time_s));
    return lowest_s;
}

OffsetInterval ClockLine::at(SessionTime near) const {
    const double time_s = to_seconds(near - start_), base_s = to_seconds(base_);
    const double highest_s =
        greatest(rate_low_, rate_high_, [&](double rate) { return highest_at(time_s, rate); });
    const double lowest_s =
        -greatest(rate_low_, rate_high_, [&](double rate) { return -lowest_at(time_s, rate); });
    return {base_s + lowest_s, base_s + highest_s};
}

}  // namespace thimble
