// The age of the forces that arrive, and how much it varies. Only the forces are needed.
//
//     A += (age - A) / 8,   J += (|D| - J) / 16
//
// A is a mean, as the round trip of RFC 6298. J is the interarrival jitter of RFC 3550 (6.4.1). D is the difference of two ages in a row.
#pragma once

#include <cmath>

namespace thimble {

class AgeEstimate {
  public:
    // Before a force came: the network's delay as it is expected.
    void start(double expected_s) {
        mean_s_ = expected_s;
        jitter_s_ = 0;
        known_ = false;
    }
    void add(double age_s) {
        if (!(age_s >= 0) || !std::isfinite(age_s)) return;
        if (known_) jitter_s_ += (std::fabs(age_s - before_s_) - jitter_s_) / 16;
        mean_s_ = known_ ? mean_s_ + (age_s - mean_s_) / 8 : age_s;
        before_s_ = age_s;
        known_ = true;
    }
    double mean_s() const { return mean_s_; }
    double jitter_s() const { return jitter_s_; }

  private:
    double mean_s_ = 0, jitter_s_ = 0, before_s_ = 0;
    bool known_ = false;
};

}  // namespace thimble
