// Lets go of the stops of a session, for somebody who has heard none of them: asks every program what it holds (stop_inquiry.hpp),
// and names it (stop_bus.hpp). A stop that is pressed while the release is under way holds. No clock: `now` is the caller's.
#pragma once

#include "common/stop_inquiry.hpp"

namespace thimble {

class StopRelease {
  public:
    // Asked for kAskTimes rounds; a stop that is heard in the last of them is still released kReleaseTimes times.
    static constexpr int kAskTimes = 4, kRounds = kAskTimes + kReleaseTimes;

    // `instance`: random per start. `at`: as StopInquiry has it.
    StopRelease(std::uint64_t instance, const StopOutlets& at)
        : out_(Role::kExperimenter, instance, {at[0], at[1], at[2], at[3], at[4], at[5]}),
          inquiry_(out_, at) {}
    StopRelease(const StopRelease&) = delete;
    StopRelease& operator=(const StopRelease&) = delete;

    // kRounds of them, every kStopRepeat.
    void round(SessionTime now);
    // What was named so far, each stop once.
    const std::vector<StopOrder>& stops() const { return stops_; }

  private:
    OutboundFlow out_;
    StopInquiry inquiry_;
    int rounds_ = 0;
    std::vector<StopOrder> stops_;
};

}  // namespace thimble
