#include "common/velocity/velocity_methods.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace thimble {

LowPassVelocity::LowPassVelocity(Duration time_constant) : time_constant_s_(to_seconds(time_constant)) {
    assert(time_constant >= Duration::zero());
}

double LowPassVelocity::advance(Duration step, double position_m) {
    const double dt_s = to_seconds(step);
    smooth_m_ += dt_s / (time_constant_s_ + dt_s) * (position_m - smooth_m_);
    return smooth_m_;
}

WindowedVelocity::WindowedVelocity(Duration window) : window_(window) { assert(window > Duration::zero()); }

double WindowedVelocity::advance(Duration step, double position_m) {
    samples_.push(step, position_m);
    // Summed anew each time and relative to the newest sample: a running sum would drift.
    double sum_m_ns = 0;
    Duration left = window_;
    for (std::size_t age = 0; age < samples_.size() && left > Duration::zero(); ++age) {
        const WindowSample& sample = samples_[age];
        const bool oldest = age + 1 == samples_.size();
        const Duration held = oldest ? left : std::min(sample.step, left);
        sum_m_ns += (sample.position_m - position_m) * static_cast<double>(held.count());
        left -= held;
    }
    return position_m + sum_m_ns / static_cast<double>(window_.count());
}

namespace {

// Quantised samples often lie exactly one quantum off the line; rounding shall not decide those.
constexpr double kBandSlack = 1 + 1e-6;

// Least-squares slope of points (age, distance) that all lie before (0, 0), which counts too.
class SlopeSums {
  public:
    void add(double age_s, double distance_m) {
        ++points_;
        age_ += age_s;
        distance_ += distance_m;
        age_age_ += age_s * age_s;
        age_distance_ += age_s * distance_m;
    }
    double slope_m_per_s() const {
        return (points_ * age_distance_ - age_ * distance_) / (points_ * age_age_ - age_ * age_);
    }

  private:
    double points_ = 1;
    double age_ = 0, distance_ = 0, age_age_ = 0, age_distance_ = 0;
};

}  // namespace

FoawVelocity::FoawVelocity(FoawFit fit, Duration window, double band_m)
    : fit_(fit), window_(window), band_m_(band_m * kBandSlack) {
    assert(window > Duration::zero() && band_m > 0);
}

void FoawVelocity::reset(double position_m) {
    samples_.reset(position_m);
    slope_m_per_s_ = 0;
    smooth_m_ = position_m;
}

double FoawVelocity::advance(Duration step, double position_m) {
    samples_.push(step, position_m);
    slope_m_per_s_ = window_slope();
    const double dt_s = to_seconds(step);
    const double carried_m = smooth_m_ + slope_m_per_s_ * dt_s;
    smooth_m_ = carried_m + dt_s / (to_seconds(kPull) + dt_s) * (position_m - carried_m);
    return smooth_m_;
}

// Each sample admits an interval of slopes; the line must have a slope in all of them, so that one pass is
// enough.
double FoawVelocity::window_slope() const {
    const double newest_m = samples_[0].position_m;
    Duration age{};
    SlopeSums sums;
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    double found_m_per_s = 0;
    for (std::size_t i = 1; i < samples_.size(); ++i) {
        age += samples_[i - 1].step;
        if (age > window_ && i > 1) break;  // the newest two always count, however far apart
        const double age_s = to_seconds(age);
        const double distance_m = newest_m - samples_[i].position_m;
        low = std::max(low, (distance_m - band_m_) / age_s);
        high = std::min(high, (distance_m + band_m_) / age_s);
        sums.add(age_s, distance_m);
        const double slope = fit_ == FoawFit::kEnd ? distance_m / age_s : sums.slope_m_per_s();
        if (!(slope >= low && slope <= high)) break;
        found_m_per_s = slope;
    }
    return found_m_per_s;
}

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
