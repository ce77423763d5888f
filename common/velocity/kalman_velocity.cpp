#include "common/velocity/kalman_velocity.hpp"

#include <cassert>
#include <cmath>

namespace thimble {
namespace {

// The fixed point of a continuous filter with the same noise per second: close enough to start from.
constexpr int kMostSteps = 100'000;
constexpr double kConverged = 1e-15;

}  // namespace

KalmanVelocity::KalmanVelocity(double acceleration_noise_m2_per_s3, double quantum_m, Duration nominal_step)
    : noise_(acceleration_noise_m2_per_s3), variance_(quantum_m * quantum_m / 12) {
    assert(noise_ > 0 && quantum_m > 0 && nominal_step > Duration::zero());
    const double dt_s = to_seconds(nominal_step);
    const double density = variance_ * dt_s;
    const double rate_per_s = std::sqrt(std::sqrt(noise_ / density));
    covariance_ = {std::sqrt(2.0) * rate_per_s * density, rate_per_s * rate_per_s * density,
                   std::sqrt(2.0) * rate_per_s * rate_per_s * rate_per_s * density};
    Gain gain = propagate(dt_s);
    for (int i = 0; i < kMostSteps; ++i) {
        const double before = covariance_.velocity;
        gain = propagate(dt_s);
        if (std::abs(covariance_.velocity - before) <= kConverged * before) break;
    }
    steady_ = covariance_;
    lag_s_ = gain.position / gain.velocity_per_s - dt_s;
}

void KalmanVelocity::reset(double position_m) {
    covariance_ = steady_;
    position_m_ = position_m;
    velocity_m_per_s_ = 0;
}

KalmanVelocity::Gain KalmanVelocity::propagate(double dt_s) {
    const auto [position, mixed, velocity] = covariance_;
    const double ahead_position =
        position + dt_s * (2 * mixed + dt_s * velocity) + noise_ * dt_s * dt_s * dt_s / 3;
    const double ahead_mixed = mixed + dt_s * velocity + noise_ * dt_s * dt_s / 2;
    const double ahead_velocity = velocity + noise_ * dt_s;
    const double seen = ahead_position + variance_;
    const Gain gain{ahead_position / seen, ahead_mixed / seen};
    covariance_ = {variance_ * gain.position, variance_ * gain.velocity_per_s,
                   ahead_velocity - gain.velocity_per_s * ahead_mixed};
    return gain;
}

double KalmanVelocity::advance(Duration step, double position_m) {
    const double dt_s = to_seconds(step);
    const Gain gain = propagate(dt_s);
    const double ahead_m = position_m_ + dt_s * velocity_m_per_s_;
    const double surprise_m = position_m - ahead_m;
    position_m_ = ahead_m + gain.position * surprise_m;
    velocity_m_per_s_ += gain.velocity_per_s * surprise_m;
    return position_m_ - lag_s_ * velocity_m_per_s_;
}

}  // namespace thimble
