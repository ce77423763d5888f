#include "common/control/local_fixture.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

LocalFixture::LocalFixture(const LocalFixtureSettings& settings)
    : settings_(settings), stiffness_N_per_m_(settings.stiffness_N_per_m) {}

void LocalFixture::reset() {
    forget();
    stiffness_N_per_m_ = settings_.stiffness_N_per_m;
}

void LocalFixture::learn(double position_hand_m, double force_N) {
    if (!std::isfinite(position_hand_m) || !std::isfinite(force_N)) return;
    if (force_N <= 0) {
        if (known_ && position_hand_m > position_m_ + settings_.lost_m) forget();
        return;
    }
    add(position_hand_m, force_N);
    if (means_.var_m2 > means_.weight * settings_.span_m * settings_.span_m)
        stiffness_N_per_m_ = std::clamp(means_.cov_N_m / means_.var_m2, 1.0, settings_.stiffest_N_per_m);
    position_m_ = means_.x_m - means_.force_N / stiffness_N_per_m_;
    known_ = true;
}

// West 1979: weighted means and moments without cancellation, the old ones fading.
void LocalFixture::add(double x_m, double force_N) {
    const double keep = 1 - 1 / settings_.memory;
    const double weight = keep * means_.weight + 1;
    const double away_m = x_m - means_.x_m;
    means_.x_m += away_m / weight;
    means_.var_m2 = keep * means_.var_m2 + away_m * (x_m - means_.x_m);
    means_.cov_N_m = keep * means_.cov_N_m + (x_m - means_.x_m) * (force_N - means_.force_N);
    means_.force_N += (force_N - means_.force_N) / weight;
    means_.weight = weight;
}

double LocalFixture::force_N(double position_hand_m) {
    if (!known_ || !std::isfinite(position_hand_m)) return 0;
    const double step_m = settings_.shift_m_per_s * settings_.sample_period_s;
    if (!rendered_) {
        rendered_m_ = std::max(position_m_, position_hand_m);
        rendered_ = true;
    } else {
        rendered_m_ += std::clamp(position_m_ - rendered_m_, -step_m, step_m);
    }
    return stiffness_N_per_m_ * std::max(0.0, position_hand_m - rendered_m_);
}

}  // namespace thimble
