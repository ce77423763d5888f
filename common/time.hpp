// Session time: a time point without now(). Logic receives `now` as an argument; the only clock
// that is ever read stands in runtime/wall_clock.cpp.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace thimble {

using Duration = std::chrono::nanoseconds;

// Deliberately without now(): std::chrono's clock requirements minus the one that breaks determinism.
struct SessionClock {
    using duration = Duration;
    using rep = duration::rep;
    using period = duration::period;
    using time_point = std::chrono::time_point<SessionClock>;
    static constexpr bool is_steady = true;
};

// Nanoseconds since the program's (real time) or the session's (virtual time) origin.
using SessionTime = SessionClock::time_point;

inline constexpr SessionTime kNever = SessionTime::max();

// std's comparison keeps its operands on the stack, and the compiler guards each of them: 5 % of virtual time.
constexpr bool operator<(SessionTime a, SessionTime b) {
    return a.time_since_epoch().count() < b.time_since_epoch().count();
}
constexpr bool operator>(SessionTime a, SessionTime b) { return b < a; }
constexpr bool operator<=(SessionTime a, SessionTime b) { return !(b < a); }
constexpr bool operator>=(SessionTime a, SessionTime b) { return !(a < b); }

constexpr double to_seconds(Duration duration) { return static_cast<double>(duration.count()) / 1e9; }

// Rounded to the nearest nanosecond, halves away from zero.
inline Duration from_seconds(double seconds) { return Duration{std::llround(seconds * 1e9)}; }

constexpr std::int64_t to_nanoseconds(SessionTime time) { return time.time_since_epoch().count(); }
constexpr SessionTime from_nanoseconds(std::int64_t nanoseconds) {
    return SessionTime{Duration{nanoseconds}};
}

}  // namespace thimble
