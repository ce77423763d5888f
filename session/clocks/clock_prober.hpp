// The clock of one peer, as the asking side measures it: when the next probe is due, which replies count, and the offset
// that follows. A reply must name a probe that was sent and not yet answered. Every other reply is only counted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

// One four-stamp exchange between two clocks, and what follows from it without any assumption about the network.
//
//     near   sent            answered           A datagram does not arrive before it was sent:
//              \               ^                     far clock at `sent`     <= arrived
//     far       arrived -> replied                   far clock at `answered` >= replied
//
// With offset(t) = far clock - near clock, t on the near clock:
//     offset(sent) <= high = arrived - sent          offset(answered) >= low = replied - answered
// So at some moment of the exchange the offset was within (low + high)/2 +- (high - low)/2, the classical estimate
// ((t2-t1)+(t3-t4))/2 and half of (round trip - hold) (Mills, RFC 5905, section 8), however asymmetric the network is.
struct ClockExchange {
    SessionTime sent{};      // t1, near clock
    SessionTime arrived{};   // t2, far clock; may be noted late, never early
    SessionTime replied{};   // t3, far clock; may be noted early, never late
    SessionTime answered{};  // t4, near clock; may be noted late, never early

    Duration high() const { return arrived - sent; }
    Duration low() const { return replied - answered; }
    double offset_s() const { return to_seconds(low() + high()) / 2; }
    double bound_s() const { return to_seconds(high() - low()) / 2; }
    Duration round_trip() const { return answered - sent; }
    // False if no two clocks could give these stamps.
    bool possible() const { return answered >= sent && high() >= low(); }
};

// Interval that contains the offset for certain. Positive: the far clock is ahead.
struct OffsetInterval {
    double low_s = 0, high_s = 0;
    double offset_s() const { return (low_s + high_s) / 2; }
    double bound_s() const { return (high_s - low_s) / 2; }
    bool empty() const { return low_s > high_s; }
};

// Of two far clocks to each other, from their offsets to the same near clock: a minus b. The bounds add.
inline OffsetInterval between(const OffsetInterval& a, const OffsetInterval& b) {
    return {a.low_s - b.high_s, a.high_s - b.low_s};
}

// Greatest rate of two clocks against each other. Linux slews each by at most 500 parts per million (adjtimex(2)).
inline constexpr double kClockRateLimit = 1e-3;

// The offset of a clock now, from the exchanges of the last few seconds: the intersection of their intervals, each
// widened by what the clocks may have moved against each other since. An intersection that is empty says that a clock
// was set, or its machine stopped: counted, and the window begins anew. A step smaller than the bounds goes unseen, and
// does not make them wrong by more than itself until it has left the window.
class ClockFilter {
  public:
    // True if it fits the window; false if a clock has stepped.
    bool add(const ClockExchange& exchange);
    // `now` on the near clock, not before the last exchange. None before the first one.
    std::optional<OffsetInterval> at(SessionTime now) const;

    std::uint64_t steps() const { return steps_; }

  private:
    OffsetInterval intersection(SessionTime now) const;
    void remember(const ClockExchange& exchange);

    std::array<ClockExchange, 64> window_{};
    std::size_t size_ = 0, next_ = 0;
    std::uint64_t steps_ = 0;
};

inline constexpr Duration kClockProbePeriod = std::chrono::milliseconds{200};

struct ClockProbeCounters {
    std::uint64_t probes = 0;      // sent
    std::uint64_t exchanges = 0;   // answered
    std::uint64_t unmatched = 0;   // replies to no outstanding probe: late, replayed, forged
    std::uint64_t impossible = 0;  // replies whose stamps no two clocks can have shown
};

class ClockProber {
  public:
    bool due(SessionTime now) const { return now >= next_; }
    ClockProbe probe(SessionTime now);
    // `replied`: send time of the reply's header; `answered`: when it arrived.
    std::optional<ClockExchange> take(const ClockReply& reply, SessionTime replied, SessionTime answered);

    const ClockFilter& filter() const { return filter_; }
    const ClockProbeCounters& counters() const { return counters_; }

  private:
    // A probe that has not come back when it is overwritten, after 3 s, is lost.
    std::array<SessionTime, 16> outstanding_ = none();
    std::size_t slot_ = 0;
    SessionTime next_{};
    ClockFilter filter_;
    ClockProbeCounters counters_;

    static constexpr std::array<SessionTime, 16> none() {
        std::array<SessionTime, 16> slots{};
        slots.fill(kNever);
        return slots;
    }
};

}  // namespace thimble
