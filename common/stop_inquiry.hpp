// Asks the programs of a session what stops they hold, for somebody who has heard none of them (stop_bus.hpp). An answer says for
// how long: what was pressed after this began is told from what holds since before it, whoever plays which question or answer
// again, and however slow the network or this program. No clock: `now` is the caller's.
#pragma once

#include <vector>

#include "common/stop_bus.hpp"

namespace thimble {

struct LatchedStop {
    Role by = Role::kSession;
    StopOrder stop;
    bool since_before = false;  // held for kHeldAtLeast, and from before the first call
};

class StopInquiry {
  public:
    // `at`: where the programs hear stops, and whence their answers come; outlives this, as `out`, which sends there.
    StopInquiry(OutboundFlow& out, const StopOutlets& at) : out_(&out), at_(at) {
        held_.reserve(kMostAnswers);
    }

    void ask(SessionTime now);
    // Takes the answers that have come, to questions or to a stop.
    void hear(SessionTime now);
    // Each stop once for each program that holds it.
    const std::vector<LatchedStop>& held() const { return held_; }

  private:
    static constexpr std::size_t kMostAnswers = 192;  // what six programs can hold
    void hear(SessionTime now, Channel& channel);
    void note(const LatchedStop& answer);

    OutboundFlow* out_;
    StopOutlets at_;
    SessionTime begun_ = kNever;  // the first call
    std::vector<LatchedStop> held_;
    Message message_;
};

}  // namespace thimble
