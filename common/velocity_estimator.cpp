#include "common/velocity_estimator.hpp"

#include <cmath>

namespace thimble {

VelocityEstimator::Method VelocityEstimator::make_method(const VelocitySettings& s) {
    switch (s.method) {
        case VelocityMethod::kRaw:
            return RawVelocity{};
        case VelocityMethod::kWindowed:
            return WindowedVelocity{s.window};
        case VelocityMethod::kFoaw:
            return FoawVelocity{s.fit, s.window, s.quantum_m};
        case VelocityMethod::kKalman:
            return KalmanVelocity{s.acceleration_noise_m2_per_s3, s.quantum_m, s.sample_period};
        case VelocityMethod::kLowPass:
            break;
    }
    return LowPassVelocity{s.time_constant};
}

VelocityEstimator::VelocityEstimator(const VelocitySettings& settings) : method_(make_method(settings)) {}

void VelocityEstimator::reset(double position_m) {
    std::visit([&](auto& method) { method.reset(position_m); }, method_);
    estimate_ = {0, position_m};
    placed_ = true;
    started_ = false;
}

VelocityEstimator::Estimate VelocityEstimator::update(SessionTime now, double position_m) {
    if (!std::isfinite(position_m)) return estimate_;
    if (!placed_) reset(position_m);
    if (!started_) {
        started_ = true;
        last_ = now;
        return estimate_;
    }
    if (now <= last_) return estimate_;
    const Duration step = now - last_;
    last_ = now;
    const double before_m = estimate_.position_estimate_m;
    estimate_.position_estimate_m =
        std::visit([&](auto& method) { return method.advance(step, position_m); }, method_);
    // From the rounded positions, so that position and velocity agree to the last bit that matters.
    estimate_.velocity_m_per_s = (estimate_.position_estimate_m - before_m) / to_seconds(step);
    return estimate_;
}

}  // namespace thimble
