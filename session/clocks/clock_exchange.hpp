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
#pragma once

#include "common/time.hpp"

namespace thimble {

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
    // False: no two clocks can have shown this.
    bool possible() const { return answered >= sent && high() >= low(); }
};

// Where an offset surely is; positive: the far clock is ahead.
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

}  // namespace thimble
