// Velocity of a sampled, quantised position: backward difference behind a first-order low-pass.
//     y += alpha (x - y),  alpha = dt / (tau + dt),  velocity = (y_new - y_old) / dt
// dt is the true distance between two samples, so lost and late samples do no harm. The smooth position y
// belongs to the velocity: its slope between two samples *is* the velocity, which a first-order hold of the
// needle relies on. y lags a steadily moving x by tau * velocity.
#pragma once

#include "common/time.hpp"

namespace thimble {

class VelocityEstimator {
  public:
    struct Estimate {
        double velocity_m_per_s = 0;
        double position_estimate_m = 0;
    };

    // tau >= 0; 0 is the raw backward difference. 5 ms keeps one encoder count at the needle (0.03 mm per 1
    // ms) to 5 mm/s instead of 30 mm/s.
    explicit VelocityEstimator(Duration time_constant = std::chrono::milliseconds(5));

    // At rest at this position. The next sample only starts the clock.
    void reset(double position_m);

    // A sample that is not later than the one before changes nothing.
    Estimate update(SessionTime now, double position_m);

  private:
    double time_constant_s_;
    Estimate estimate_;
    SessionTime last_{};
    bool placed_ = false;   // the position is known
    bool started_ = false;  // the time is known
};

}  // namespace thimble
