#include "common/velocity/foaw_velocity.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace thimble {
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

}  // namespace thimble
