// Lets go of the stops of a session, for somebody who has heard none of them: asks every program what it holds, and names it
// (stop_line.hpp). Only what is heard in answer to the question is let go of, and only that is answered which had been held for
// kHeldAtLeast: a stop that is pressed while the release is under way holds. No clock: `now` is the caller's.
#pragma once

#include <array>
#include <vector>

#include "common/stop_line.hpp"

namespace thimble {

class StopRelease {
  public:
    // Asked for kAskTimes rounds; a stop that is heard in the last of them is still released kReleaseTimes times.
    static constexpr int kAskTimes = 4, kRounds = kAskTimes + kReleaseTimes;

    // `instance`: random per start. `at`: where the programs hear stops, and whence their answers come; outlives this.
    StopRelease(std::uint64_t instance, const StopOutlets& at);

    // kRounds of them, every kStopRepeat.
    void round(SessionTime now);
    // What was named so far.
    const std::vector<StopOrder>& stops() const { return stops_; }

  private:
    static constexpr std::size_t kMostStops = 64;
    void hear(Channel& channel);
    void note(const StopOrder& stop);

    StopOutlets at_;
    OutboundFlow out_;
    int rounds_ = 0;
    std::vector<StopOrder> stops_;
    Message message_;
};

}  // namespace thimble
