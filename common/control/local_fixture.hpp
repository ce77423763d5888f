// Model-mediated: the feedback tells where the fixture is, and the handle renders a spring of its own there, without
// delay (in the manner of Hannaford 1989; Mitra and Niemeyer 2008).
//
// Estimator: pairs (x, F) of the same instant come back, whatever the delay, and in contact F = K (x - z). K and z by
// least squares with exponential forgetting of `memory` pairs:
//     K = cov(x, F) / var(x) within [1, stiffest],   z = mean x - mean F / K
// While the pairs span less than `span`, K stays as it was; it starts at stiffness_N_per_m. The first contact is felt
// one delay late. The rendered plane then starts at the hand and moves to its estimate by at most shift_m_per_s. So a
// wrong estimate gives at most force limit x shift_m_per_s of power. Beyond that it is not passive: K h / 2 must be
// below the hand's damping. Pairs beyond the plane without force remove the plane. SI units, frame: hand; F positive
// pushes the hand out.
#pragma once

#include <algorithm>
#include <cmath>

namespace thimble {

struct LocalFixtureSettings {
    double stiffness_N_per_m = 3000;  // before there is an estimate
    double stiffest_N_per_m = 9000;   // > 0
    double memory = 200;              // pairs, >= 1
    double span_m = 1e-4;             // > 0; a few steps of the encoder
    double shift_m_per_s = 0.02;      // > 0
    double lost_m = 2e-3;             // so far beyond the plane without force: the fixture is gone
    double sample_period_s = 1e-3;
};

class LocalFixture {
  public:
    explicit LocalFixture(const LocalFixtureSettings& settings)
        : settings_(settings), stiffness_N_per_m_(settings.stiffness_N_per_m) {}
    void reset() {
        forget();
        stiffness_N_per_m_ = settings_.stiffness_N_per_m;
    }

    // From now on: how many pairs count, and how fast the plane may move.
    void adapt(double memory, double shift_m_per_s) {
        settings_.memory = memory;
        settings_.shift_m_per_s = shift_m_per_s;
    }

    // A pair from the feedback. Values that are no number are left out.
    void learn(double position_hand_m, double force_N) {
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

    // Once per sample, before its forces: each moves the plane by at most one step from where it is now.
    void next_sample() { from_m_ = rendered_m_; }

    // The spring's force for this position of the hand.
    double force_N(double position_hand_m) {
        if (!known_ || !std::isfinite(position_hand_m)) return 0;
        const double step_m = settings_.shift_m_per_s * settings_.sample_period_s;
        if (!rendered_) {
            from_m_ = rendered_m_ = std::max(position_m_, position_hand_m);
            rendered_ = true;
        } else {
            rendered_m_ = from_m_ + std::clamp(position_m_ - from_m_, -step_m, step_m);
        }
        return stiffness_N_per_m_ * std::max(0.0, position_hand_m - rendered_m_);
    }

    bool known() const { return known_; }
    double stiffness_N_per_m() const { return stiffness_N_per_m_; }
    double position_m() const { return position_m_; }  // estimated

  private:
    struct Means {
        double weight = 0, x_m = 0, force_N = 0;
        double var_m2 = 0, cov_N_m = 0;  // about the means, times weight
    };
    // West 1979: weighted means and moments without cancellation, the old ones fading.
    void add(double x_m, double force_N) {
        const double keep = 1 - 1 / settings_.memory;
        const double weight = keep * means_.weight + 1;
        const double away_m = x_m - means_.x_m;
        means_.x_m += away_m / weight;
        means_.var_m2 = keep * means_.var_m2 + away_m * (x_m - means_.x_m);
        means_.cov_N_m = keep * means_.cov_N_m + (x_m - means_.x_m) * (force_N - means_.force_N);
        means_.force_N += (force_N - means_.force_N) / weight;
        means_.weight = weight;
    }

    void forget() {
        known_ = rendered_ = false;
        means_ = {};
    }

    LocalFixtureSettings settings_;
    Means means_;
    bool known_ = false, rendered_ = false;
    double stiffness_N_per_m_, position_m_ = 0, rendered_m_ = 0;
    double from_m_ = 0;  // rendered when the sample began
};

}  // namespace thimble
