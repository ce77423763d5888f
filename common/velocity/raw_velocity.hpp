// No estimator at all: the smooth position is the sample, the velocity the backward difference.
//     y_k = x_k,  v_k = (x_k - x_{k-1}) / dt
// No lag but half a step. One encoder quantum q is a velocity of q / dt: 30 mm/s at the needle and 1 kHz.
#pragma once

#include "common/time.hpp"

namespace thimble {

class RawVelocity {
  public:
    void reset(double /*position_m*/) {}
    double advance(Duration /*step*/, double position_m) { return position_m; }
};

}  // namespace thimble
