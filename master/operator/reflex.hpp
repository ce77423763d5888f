// Long-latency stretch reflex. It counters a stretch of the arm one latency later, before any decision.
// Only a change within the window W counts, so a steady load gives no answer. The reflex would wind up against a wall otherwise.
// The response lies 50 to 100 ms after the stretch [V] (abstracts of Pruszynski and Scott 2012, Exp Brain Res 218:341, and of
// Kurtzer 2015, Front Integr Neurosci 8:99). It is larger where the environment is compliant [V] (abstract of Shemmell, Krutky and
// Perreault 2010, Clin Neurophysiol 121:1680). The law itself and its gain are [A].
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "master/operator/operator_parameters.hpp"
#include "master/operator/perception.hpp"

namespace thimble {

// x_reflex(t) = -g (e(t - L) - e(t - L - W)), with e = x_a - x_cmd
class StretchReflex {
  public:
    explicit StretchReflex(const ReflexParameters& parameters)
        : gain_(parameters.gain),
          latency_(ticks(parameters.latency_s)),
          past_(gain_ > 0 ? latency_ + ticks(parameters.window_s) + 1 : 0) {}

    // Once per brain tick; in metres, to add to the arm's equilibrium.
    double answer(double position_arm_m, double intended_m) {
        if (past_.empty()) return 0;
        past_[next_] = position_arm_m - intended_m;
        const std::size_t size = past_.size();
        const double late_m = past_[(next_ + size - latency_) % size];
        next_ = (next_ + 1) % size;  // the oldest
        return -gain_ * (late_m - past_[next_]);
    }

  private:
    static std::size_t ticks(double seconds) {
        return static_cast<std::size_t>(std::max<std::int64_t>(brain_ticks(seconds), 1));
    }

    double gain_;
    std::size_t latency_;
    std::vector<double> past_;  // a ring, zero before the trial: the arm was where it was meant to be
    std::size_t next_ = 0;
};

}  // namespace thimble
