// The asking side of clock exchanges with one peer: when the next probe is due, and which replies count. A reply must
// name a probe that was sent and not yet answered; everything else is counted and otherwise harmless.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/messages.hpp"
#include "session/clocks/clock_exchange.hpp"

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

    const ClockProbeCounters& counters() const { return counters_; }

  private:
    // A probe that has not come back when it is overwritten, after 3 s, is lost.
    std::array<SessionTime, 16> outstanding_ = none();
    std::size_t slot_ = 0;
    SessionTime next_{};
    ClockProbeCounters counters_;

    static constexpr std::array<SessionTime, 16> none() {
        std::array<SessionTime, 16> slots{};
        slots.fill(kNever);
        return slots;
    }
};

}  // namespace thimble
