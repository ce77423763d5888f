#include "session/clocks/clock_prober.hpp"

#include <algorithm>
#include <limits>

namespace thimble {

bool ClockFilter::add(const ClockExchange& exchange) {
    remember(exchange);
    if (!intersection(exchange.answered).empty()) return true;
    ++steps_;
    size_ = next_ = 0;
    remember(exchange);
    return false;
}

std::optional<OffsetInterval> ClockFilter::at(SessionTime now) const {
    if (size_ == 0) return std::nullopt;
    return intersection(now);
}

// Each half of an interval holds at its own end of the exchange. Replies may overtake each other:
// an exchange may be younger than `now` of the one that arrived last.
OffsetInterval ClockFilter::intersection(SessionTime now) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    OffsetInterval common{-kInfinity, kInfinity};
    const auto drift_s = [&](SessionTime then) { return kClockRateLimit * std::abs(to_seconds(now - then)); };
    for (std::size_t i = 0; i < size_; ++i) {
        const ClockExchange& e = window_[i];
        common.low_s = std::max(common.low_s, to_seconds(e.low()) - drift_s(e.answered));
        common.high_s = std::min(common.high_s, to_seconds(e.high()) + drift_s(e.sent));
    }
    return common;
}

void ClockFilter::remember(const ClockExchange& exchange) {
    window_[next_] = exchange;
    next_ = (next_ + 1) % window_.size();
    size_ = std::min(size_ + 1, window_.size());
}

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
