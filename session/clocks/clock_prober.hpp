// The clock of one peer, as the asking side measures it: when the next probe is due, which replies count, and the offset
// that follows. A reply must name a probe that was sent and not yet answered. Every other reply is only counted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/messages.hpp"
#include "session/clocks/clock_filter.hpp"

namespace thimble {

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
