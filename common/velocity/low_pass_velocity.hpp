// Backward difference behind a first-order low-pass.
//     y_k = y_{k-1} + a (x_k - y_{k-1}),  a = dt / (tau + dt),  v_k = (y_k - y_{k-1}) / dt
// y lags a steadily moving x by tau (times the velocity). One quantum q is a velocity of q / (tau + dt) that
// fades with tau.
#pragma once

#include "common/time.hpp"

namespace thimble {

class LowPassVelocity {
  public:
    // tau >= 0 (asserted); 0 gives the raw difference.
    explicit LowPassVelocity(Duration time_constant);

    void reset(double position_m) { smooth_m_ = position_m; }
    double advance(Duration step, double position_m);

  private:
    double time_constant_s_;
    double smooth_m_ = 0;
};

}  // namespace thimble
