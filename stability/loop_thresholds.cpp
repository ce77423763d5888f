// The borders between two outcomes: the swing that friction stops, the press that ends the limit cycle.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {
namespace {

constexpr double kFirstSwing_m = 1e-7, kLongest_s = 120;

// Greatest |p| since the last zero crossing, said at each crossing.
class SwingMeter {
  public:
    // Whether a half swing has ended with this sample.
    bool add(double position_m) {
        const bool crossed = (position_m > 0) != positive_;
        if (crossed) {
            last_m_ = now_m_;
            now_m_ = 0;
            positive_ = position_m > 0;
        }
        now_m_ = std::max(now_m_, std::abs(position_m));
        return crossed;
    }
    double last_m() const { return last_m_; }

  private:
    bool positive_ = true;
    double now_m_ = 0, last_m_ = 0;
};

// A loop that swings up from nothing, and rubs from the first half swing of some size on.
struct RubbedRun {
    bool grows = false;
    double steady_m = 0;  // the half swing that differed least from the one before the last
};

RubbedRun run_rubbed(const LoopConditions& conditions, double from_m, double friction_N) {
    constexpr double kFar = 3;
    LoopSimulator run(conditions, kFirstSwing_m, 0);
    SwingMeter meter;
    const auto most = static_cast<long>(kLongest_s / conditions.loop.step_s), still = most / 60;
    RubbedRun result;
    bool rubs = false;
    double least = 1, before_m = 0, last_m = 0;
    for (long i = 0, quiet = 0; i < most && (!rubs || quiet < still); ++i, ++quiet) {
        run.step();
        if (!meter.add(run.position_m())) continue;
        quiet = 0;
        const double swing_m = meter.last_m();
        if (!rubs) {
            rubs = swing_m >= from_m;
            if (rubs) run.rub(friction_N);
            continue;
        }
        if (before_m > 0 && std::abs(std::log(swing_m / before_m)) < least) {
            least = std::abs(std::log(swing_m / before_m));
            result.steady_m = swing_m;
        }
        before_m = std::exchange(last_m, swing_m);
        result.grows = swing_m > from_m;
        if (swing_m > kFar * from_m || swing_m < from_m / kFar) return result;
    }
    if (!rubs)
        throw Error(ExitCode::kUsage, "stability: this loop does not swing up, so friction has no threshold");
    result.grows = false;  // sticks
    return result;
}

}  // namespace

double measured_friction_threshold_m(const SampledLoop& loop, double friction_N) {
    LoopConditions conditions;
    conditions.loop = loop;
    constexpr double kFine = 1 + 1e-7;  // close to it for many swings
    constexpr double kWidest_m = 1e3;
    double low = 2 * kFirstSwing_m, high = low;
    while (high < kWidest_m && !run_rubbed(conditions, high, friction_N).grows) {
        low = high;
        high *= 4;
    }
    while (high / low > kFine) {
        const double middle = std::sqrt(low * high);
        (run_rubbed(conditions, middle, friction_N).grows ? high : low) = middle;
    }
    return run_rubbed(conditions, high, friction_N).steady_m;
}

double measured_press_fold_N(const LoopConditions& conditions, double rise_N_per_s) {
    constexpr double kSwinging_s = 3, kKept_s = 1;
    LoopConditions start = conditions;
    start.press_N = conditions.force_limit_N / 2;
    LoopSimulator run(start, -5e-3, 0.1);
    const double step_s = conditions.loop.step_s;
    const auto swinging = static_cast<long>(kSwinging_s / step_s), kept = static_cast<long>(kKept_s / step_s);
    double press_N = start.press_N, cycled_N = press_N;
    // The strip is where the force changes; a cycle leaves it at one side or the other again and again.
    const double strip_m = conditions.force_limit_N / conditions.loop.stiffness_N_per_m;
    long since = 0;
    bool beyond = false;
    for (long i = 0; since < kept; ++i, ++since) {
        if (i >= swinging) run.press(press_N += rise_N_per_s * step_s);
        run.step();
        const bool now = run.sampled_m() > strip_m;
        if (now == beyond) continue;
        beyond = now;
        cycled_N = press_N;
        since = 0;
    }
    return cycled_N;
}

}  // namespace thimble
