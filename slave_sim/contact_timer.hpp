// How long the needle has touched the fixture without a break, on the times of the samples. Integer
// nanoseconds: five seconds are five seconds after any number of samples.
#pragma once

#include "common/time.hpp"

namespace thimble {

class ContactTimer {
  public:
    // hold > 0: unbroken contact that makes the beep due.
    explicit ContactTimer(Duration hold) : hold_(hold) {}

    // A new trial: no contact, and the beep is still to come.
    void reset() {
        lose_contact();
        beeped_ = false;
    }

    void lose_contact() {
        touching_ = false;
        time_ = Duration::zero();
    }

    // One sample. Contact counts from its first sample on. True once per trial: when the time first reaches
    // hold.
    bool update(SessionTime sample_time, bool touching) {
        if (!touching) {
            lose_contact();
            return false;
        }
        if (!touching_) since_ = sample_time;
        touching_ = true;
        time_ = sample_time - since_;
        const bool due = !beeped_ && time_ >= hold_;
        beeped_ = beeped_ || due;
        return due;
    }

    Duration time() const { return time_; }

  private:
    Duration hold_;
    Duration time_{};
    SessionTime since_{};
    bool touching_ = false;
    bool beeped_ = false;
};

}  // namespace thimble
