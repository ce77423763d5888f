// Age of the force at the handle, from the echo in each ForceFeedback: both stamps are the master's, so no
// clock needs to be synchronised.
#pragma once

#include "common/histogram.hpp"
#include "common/messages.hpp"

namespace thimble {

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

}  // namespace thimble
