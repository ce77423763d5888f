#include "common/velocity_estimator.hpp"

#include <cassert>

namespace thimble {

VelocityEstimator::VelocityEstimator(Duration time_constant) : time_constant_s_(to_seconds(time_constant)) {
    assert(time_constant >= Duration::zero());
}

void VelocityEstimator::reset(double position_m) {
    estimate_ = {0, position_m};
    placed_ = true;
    started_ = false;
}

VelocityEstimator::Estimate VelocityEstimator::update(SessionTime now, double position_m) {
    if (!placed_) reset(position_m);
    if (!started_) {
        started_ = true;
        last_ = now;
        return estimate_;
    }
    if (now <= last_) return estimate_;
    const double dt_s = to_seconds(now - last_);
    last_ = now;
    const double before_m = estimate_.position_estimate_m;
    estimate_.position_estimate_m += dt_s / (time_constant_s_ + dt_s) * (position_m - before_m);
    // From the rounded positions, so that position and velocity agree to the last bit that matters.
    estimate_.velocity_m_per_s = (estimate_.position_estimate_m - before_m) / dt_s;
    return estimate_;
}

}  // namespace thimble
