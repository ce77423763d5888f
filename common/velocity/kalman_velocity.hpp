// Kalman filter of a position with white acceleration of density q, measured with the variance R = D^2/12 of a
// quantum D (uniform within one step). State s (position) and w (velocity), for any step dt:
//     s += w dt,  P = F P F' + q [dt^3/3 dt^2/2; dt^2/2 dt]
//     K = P (1, 0)' / (P11 + R),  (s, w) += K (x - s),  P = (1 - K (1, 0)) P
// (Y. Bar-Shalom, X. R. Li and T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001,
// 6.2). P depends on the steps only, not on the samples; it starts at its fixed point for the nominal step,
// so even sampling has constant gains from the start and nothing drifts.
//
// The slope of s is not w: s also jumps by K1 (x - s) with each sample. The position that belongs to w is
//     y = s - L w,  L = K1 / K2 - dt,  with the nominal gains,
// for then y_k - y_{k-1} = dt w_k at even sampling. Its slope, the velocity given out, is w to rounding then,
// and w + (K1 / dt - (L / dt + 1) K2) (x - s) at any other step, where the bracket is about K2 times the
// step's relative deviation. y lags a steadily moving x by L; for slow filters (W dt << 1) L = sqrt(2) / W
// with W^4 = q / (R dt), and y = W^2 / (p^2 + sqrt(2) W p + W^2) x.
#pragma once

#include "common/time.hpp"

namespace thimble {

class KalmanVelocity {
  public:
    // All > 0 (asserted). q: variance of velocity gained per second.
    KalmanVelocity(double acceleration_noise_m2_per_s3, double quantum_m, Duration nominal_step);

    void reset(double position_m);
    double advance(Duration step, double position_m);

    double lag_s() const { return lag_s_; }                              // L
    double velocity_state_m_per_s() const { return velocity_m_per_s_; }  // w
    double velocity_variance_m2_per_s2() const { return covariance_.velocity; }

  private:
    struct Covariance {
        double position = 0, mixed = 0, velocity = 0;
    };
    struct Gain {
        double position, velocity_per_s;
    };
    // One step of P; returns the K it gives.
    Gain propagate(double dt_s);

    double noise_;     // q
    double variance_;  // R
    Covariance covariance_;
    Covariance steady_;
    double lag_s_ = 0;
    double position_m_ = 0;        // s
    double velocity_m_per_s_ = 0;  // w
};

}  // namespace thimble
