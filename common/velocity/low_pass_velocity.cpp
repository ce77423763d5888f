#include "common/velocity/low_pass_velocity.hpp"

#include <cassert>

namespace thimble {

LowPassVelocity::LowPassVelocity(Duration time_constant) : time_constant_s_(to_seconds(time_constant)) {
    assert(time_constant >= Duration::zero());
}

double LowPassVelocity::advance(Duration step, double position_m) {
    const double dt_s = to_seconds(step);
    smooth_m_ += dt_s / (time_constant_s_ + dt_s) * (position_m - smooth_m_);
    return smooth_m_;
}

}  // namespace thimble
