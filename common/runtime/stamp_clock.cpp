#include "common/runtime/stamp_clock.hpp"

#include <algorithm>

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// Two clock readings in a row take well under a microsecond; more means that something ran between them.
constexpr Duration kTornPair = microseconds{5};
// The kernel slews by at most 500 parts per million; more is a step.
constexpr std::int64_t kSlewDivisor = 2000;
// A stamp from before a step may be read after it.
constexpr Duration kDoubtAfterStep = milliseconds{100};
// No socket buffer holds a datagram that long unless this program was stopped.
constexpr Duration kOldest = seconds{10};

}  // namespace

void StampClock::update(const ClockPair& pair) {
    const Duration width = pair.after - pair.before;
    const bool first = doubtful_until_ == kNever;
    if (width > kTornPair && !first) return;
    const std::int64_t offset_ns = to_nanoseconds(pair.before) + width.count() / 2 - pair.realtime_ns;
    const Duration allowed = 2 * kTornPair + (pair.before - read_at_) / kSlewDivisor;
    if (first) {
        doubtful_until_ = SessionTime{};
    } else if (std::abs(offset_ns - offset_ns_) > allowed.count()) {
        ++steps_;
        doubtful_until_ = pair.after + kDoubtAfterStep;
    }
    offset_ns_ = offset_ns;
    read_at_ = pair.before;
}

SessionTime StampClock::to_session(std::int64_t stamp_realtime_ns, SessionTime now) {
    const SessionTime stamp = from_nanoseconds(stamp_realtime_ns + offset_ns_);
    const bool possible = stamp <= now + kTornPair && stamp > now - kOldest;
    if (now < doubtful_until_ || !possible) {
        ++untrusted_;
        return now;
    }
    return std::min(stamp, now);
}

SessionTime ArrivalClock::arrival(std::int64_t stamp_realtime_ns) {
    const ClockPair pair = read_clock_pair();
    if (stamp_realtime_ns == 0 || pair.after - pair.before > kTornPair) return pair.after;
    clock_.update(pair);
    // A pair tells the offset to half its width.
    return std::min(clock_.to_session(stamp_realtime_ns, pair.after) + kTornPair, pair.after);
}

}  // namespace thimble
