// Asks the programs of a session which stops they hold, for a program outside the session (stop_bus.hpp). An answer says for
// how long: what was pressed after this began is told from what holds since before it, whoever plays which question or answer
// again, and however slow the network or this program. No clock: `now` is the caller's.
#pragma once

#include <vector>

#include <boost/core/noncopyable.hpp>

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

// Releases the stops of a session from outside it: asks every program which stops it holds (stop_inquiry.hpp),
// and names it (stop_bus.hpp). A stop that is pressed while the release is under way holds. No clock: `now` is the caller's.

class StopRelease : boost::noncopyable {
  public:
    // Asked for kAskTimes rounds; a stop that is heard in the last of them is still released kReleaseTimes times.
    static constexpr int kAskTimes = 4, kRounds = kAskTimes + kReleaseTimes;

    // `instance`: random per start. `at`: as StopInquiry has it.
    StopRelease(std::uint64_t instance, const StopOutlets& at)
        : out_(Role::kExperimenter, instance, {at[0], at[1], at[2], at[3], at[4], at[5]}),
          inquiry_(out_, at) {}

    // kRounds of them, every kStopRepeat.
    void round(SessionTime now);
    // The stops named so far, each once.
    const std::vector<StopOrder>& stops() const { return stops_; }

  private:
    OutboundFlow out_;
    StopInquiry inquiry_;
    int rounds_ = 0;
    std::vector<StopOrder> stops_;
};

}  // namespace thimble
