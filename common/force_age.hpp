// How late a force is, beyond the delay of the session's network. A rising delay does not show as silence: packets
// still arrive, but old.
#pragma once

#include <algorithm>

#include "common/histogram.hpp"
#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

// Round trip of encoder sample and force, from the echo in each ForceFeedback. Both stamps are the master's, so no clock needs
// to be synchronised.
class RoundTrip {
  public:
    void clear() {
        age_.clear();
        hold_.clear();
    }
    // `now`: when the feedback arrived, on the clock that stamped the command it echoes.
    void add(SessionTime now, const ForceFeedback& feedback) {
        age_.add(now - feedback.echo_time);
        hold_.add(feedback.hold_time);
    }
    const Histogram& age() const { return age_; }    // encoder sample to force at the handle
    const Histogram& hold() const { return hold_; }  // the part of it inside slave_sim

  private:
    Histogram age_, hold_;
};

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
    // A force with a stamp of another program's clock: its age is unknown. Its age relative to the fastest packet of
    // this trial is known, corrected for clock drift of 1/1000 (twice what NTP may slew a clock by).
    void take_from_elsewhere(SessionTime now, SessionTime made) {
        if (least_ != Duration::max()) least_ += (now - taken_) / kDrift;
        least_ = std::min(least_, now - made);
        made_ = made + least_;
        taken_ = now;
    }

    // Lateness of the newest force; negative while it is in time.
    Duration late(SessionTime now) const { return late(now, made_); }
    // Of one that answers what this program said at `made`.
    Duration late(SessionTime now, SessionTime made) const { return now - made - allowed_; }

  private:
    static constexpr int kDrift = 1000;
    Duration allowed_{}, least_ = Duration::max();
    SessionTime made_{}, taken_{};
};

}  // namespace thimble
