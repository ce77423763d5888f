// The five methods of velocity_estimator.hpp. Each makes a smooth position y of the samples x; the velocity is the slope of y.
#pragma once

#include <array>
#include <cassert>
#include <chrono>
#include <cstddef>

#include "common/time.hpp"

namespace thimble {

// No estimator at all: the smooth position is the sample, the velocity the backward difference.
//     y_k = x_k,  v_k = (x_k - x_{k-1}) / dt
// No lag but half a step. One encoder quantum q is a velocity of q / dt: 30 mm/s at the needle and 1 kHz.
class RawVelocity {
  public:
    void reset(double /*position_m*/) {}
    double advance(Duration /*step*/, double position_m) { return position_m; }
};

// Backward difference behind a first-order low-pass.
//     y_k = y_{k-1} + a (x_k - y_{k-1}),  a = dt / (tau + dt),  v_k = (y_k - y_{k-1}) / dt
// y lags a steadily moving x by tau (times the velocity). One quantum q is a velocity of q / (tau + dt) that
// fades with tau.
class LowPassVelocity {
  public:
    // tau >= 0 (asserted); 0 gives the raw difference.
    explicit LowPassVelocity(Duration time_constant);

    void reset(double position_m) { smooth_m_ = position_m; }
    double advance(Duration step, double position_m);

  private:
    double time_constant_s_;
    double smooth_m_ = 0;
};

// The newest samples of a position, each with its distance in time from the one before. Fixed room: a sample
// that finds the window full pushes out the oldest.
struct WindowSample {
    Duration step{};  // since the sample before; > 0 except for the very first
    double position_m = 0;
};

class SampleWindow {
  public:
    static constexpr std::size_t kCapacity = 256;  // a power of two, so that wrapping is cheap

    // Empty but for one sample.
    void reset(double position_m) {
        newest_ = 0;
        size_ = 1;
        samples_[0] = {Duration{0}, position_m};
    }

    void push(Duration step, double position_m) {
        newest_ = (newest_ + 1) % kCapacity;
        samples_[newest_] = {step, position_m};
        if (size_ < kCapacity) ++size_;
    }

    std::size_t size() const { return size_; }

    // 0 is the newest; age < size().
    const WindowSample& operator[](std::size_t age) const {
        assert(age < size_);
        return samples_[(newest_ + kCapacity - age) % kCapacity];
    }

  private:
    std::array<WindowSample, kCapacity> samples_{};
    std::size_t newest_ = 0;
    std::size_t size_ = 1;
};

// Difference over a window of fixed duration W, as the Force Dimension SDK does it by default (W = 20 ms).
//     y_k = mean of x over (t_k - W, t_k],  v_k = (y_k - y_{k-1}) / dt
// where a sample counts for the time since the one before it. At even sampling, with W a multiple of dt, this
// is v_k = (x_k - x(t_k - W)) / W to rounding: the moving average is the position whose slope that is.
// Uneven samples keep the relation; x(t - W) then is the mean over a step that ended W ago.
//
// y lags a steadily moving x by (W - dt) / 2 and stays within the range of the samples. One quantum q is a
// velocity of q / W that lasts for W.
class WindowedVelocity {
  public:
    // window > 0 (asserted). If more samples fall into it than there is room for, the oldest known one stands
    // for those before it.
    explicit WindowedVelocity(Duration window);

    void reset(double position_m) { samples_.reset(position_m); }
    double advance(Duration step, double position_m);

  private:
    Duration window_;
    SampleWindow samples_;
};

// First-order adaptive window: F. Janabi-Sharifi, V. Hayward and C.-S. J. Chen, "Discrete-time adaptive
// windowing for velocity estimation", IEEE Trans. Control Systems Technology 8(6), 2000, 1003-1009.
//
// The window grows back from the newest sample, one sample at a time, as long as the straight line through
// the newest sample with the window's slope b passes all samples of the window within a band d; the first
// failure ends it. So it is long while the hand moves evenly and short while it does not.
//     end fit   b = (x_k - x_{k-n}) / (t_k - t_{k-n})
//     best fit  b = least-squares slope of x_{k-n} ... x_k
// d is one quantum: the line's ends and the samples are each off by half a quantum at most.
//
// b has no smooth position of its own: as the window's length jumps, so would any mean over it. The smooth
// position therefore goes along with b and is drawn to the samples slowly, with time constant P:
//     p = y_{k-1} + b dt,  y_k = p + dt / (P + dt) (x_k - p)
// Its slope, the velocity given out, is b + (x_k - p) / (P + dt). On a straight line it is b, and y has no lag;
// after a change of velocity by dv the second term is about dv times the lag of b, divided by P.
enum class FoawFit { kBest, kEnd };

class FoawVelocity {
  public:
    // P. Long, because the pull is an error of the velocity; short enough that y finds back within a second.
    static constexpr Duration kPull = std::chrono::milliseconds{100};

    // window > 0, the longest; band > 0, in the unit of the samples (asserted).
    FoawVelocity(FoawFit fit, Duration window, double band_m);

    void reset(double position_m);
    double advance(Duration step, double position_m);

    double slope_m_per_s() const { return slope_m_per_s_; }  // b of the last sample

  private:
    double window_slope() const;

    FoawFit fit_;
    Duration window_;
    double band_m_;
    SampleWindow samples_;
    double slope_m_per_s_ = 0;
    double smooth_m_ = 0;
};

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
