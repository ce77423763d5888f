// Difference over a window of fixed duration W, as the Force Dimension SDK does it by default (W = 20 ms).
//     y_k = mean of x over (t_k - W, t_k],  v_k = (y_k - y_{k-1}) / dt
// where a sample counts for the time since the one before it. At even sampling, with W a multiple of dt, this
// is v_k = (x_k - x(t_k - W)) / W to rounding: the moving average is the position whose slope that is.
// Uneven samples keep the relation; x(t - W) then is the mean over a step that ended W ago.
//
// y lags a steadily moving x by (W - dt) / 2 and stays within the range of the samples. One quantum q is a
// velocity of q / W that lasts for W.
#pragma once

#include "common/time.hpp"
#include "common/velocity/sample_window.hpp"

namespace thimble {

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

}  // namespace thimble
