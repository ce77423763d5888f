// How much later a force is than the session's network lets it be. Silence does not show a delay that grows: news come, and are old.
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace thimble {

class ForceAge {
  public:
    // `allowed`: the longest delay that the session knows of. Nothing is late before an input can have come.
    void begin(SessionTime now, Duration allowed) {
        allowed_ = allowed;
        made_ = now;
        least_ = Duration::max();
        taken_ = now;
    }
    // The network has changed. Packets under way still have the old delay, so the allowed age never falls within a trial.
    void allow(Duration longest) { allowed_ = std::max(allowed_, longest); }

    // A force that answers what this program said at `made`.
    void take(SessionTime made) { made_ = made; }
    // One that another program made at `made` on its own clock: its age is unknown here, but not how much older it is than the youngest of this trial. Clocks of two machines drift apart, so what was the youngest may be a thousandth of the time since
    // then older than it was: twice what NTP may slew a clock by.
    void take_from_elsewhere(SessionTime now, SessionTime made) {
        if (least_ != Duration::max()) least_ += (now - taken_) / kDrift;
        least_ = std::min(least_, now - made);
        made_ = made + least_;
        taken_ = now;
    }

    // Of the newest force; negative while it is as young as it may be.
    Duration late(SessionTime now) const { return now - made_ - allowed_; }

  private:
    static constexpr int kDrift = 1000;
    Duration allowed_{}, least_ = Duration::max();
    SessionTime made_{}, taken_{};
};

}  // namespace thimble
