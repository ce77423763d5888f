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
#pragma once

#include <chrono>

#include "common/time.hpp"
#include "common/velocity/sample_window.hpp"

namespace thimble {

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

}  // namespace thimble
