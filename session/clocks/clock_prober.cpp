#include "session/clocks/clock_prober.hpp"

#include <algorithm>

namespace thimble {

ClockProbe ClockProber::probe(SessionTime now) {
    next_ = now + kClockProbePeriod;
    slot_ = (slot_ + 1) % outstanding_.size();
    outstanding_[slot_] = now;
    ++counters_.probes;
    return {now};
}

std::optional<ClockExchange> ClockProber::take(const ClockReply& reply, SessionTime replied,
                                               SessionTime answered) {
    const auto found = std::find(outstanding_.begin(), outstanding_.end(), reply.probe_send_time);
    if (found == outstanding_.end() || *found == kNever) {
        ++counters_.unmatched;
        return std::nullopt;
    }
    const ClockExchange exchange{*found, reply.probe_arrival_time, replied, answered};
    *found = kNever;
    if (!exchange.possible()) {
        ++counters_.impossible;
        return std::nullopt;
    }
    ++counters_.exchanges;
    filter_.add(exchange);
    return exchange;
}

}  // namespace thimble
